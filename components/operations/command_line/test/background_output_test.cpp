#include "operations/command_line/background_output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <string>

namespace usher::operations {
namespace {

/// A pipe; nobody reads it until it is asked for its content.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(::pipe(ends_.data()), 0); }
  /// So much that it takes nothing more.
  std::string fill() const {
    const int size = ::fcntl(ends_[1], F_GETPIPE_SZ);
    EXPECT_GT(size, 0);
    std::string filling(static_cast<std::size_t>(size), '-');
    EXPECT_EQ(::write(ends_[1], filling.data(), filling.size()), size);
    return filling;
  }
  ~Pipe() {
    close_reader();
    ::close(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int writer() const { return ends_[1]; }
  void close_reader() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }
  /// What is in it, without waiting.
  std::string content() const {
    std::string all;
    pollfd entry{ends_[0], POLLIN, 0};
    std::array<char, 4096> bytes{};
    while (::poll(&entry, 1, 0) > 0) {
      const ssize_t count = ::read(ends_[0], bytes.data(), bytes.size());
      if (count <= 0) break;
      all.append(bytes.data(), static_cast<std::size_t>(count));
    }
    return all;
  }
  std::string read_until_idle(const BackgroundOutput& output) const {
    std::string all;
    while (!output.idle()) all += content();
    return all + content();
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

std::string line(int number) { return std::to_string(number) + std::string(1000, '.') + "\n"; }

// Who is held up by a pipe that nobody reads never ends this test.
TEST(BackgroundOutput, HoldsUpNobodyWhereNobodyReads) {
  const Pipe pipe;
  std::string expected = pipe.fill();
  BackgroundOutput output(pipe.writer());
  constexpr int kLines = 100;
  for (int i = 0; i < kLines; ++i) output.say(line(i));
  EXPECT_FALSE(output.idle());

  const std::string heard = pipe.read_until_idle(output);
  int lines = 0;
  while (expected.size() < heard.size()) expected += line(lines++);
  EXPECT_EQ(heard, expected) << "whole lines, in order";
  EXPECT_GT(lines, 0);
  ASSERT_LT(lines, kLines);

  output.say("afterwards\n");
  EXPECT_EQ(
      pipe.read_until_idle(output),
      "(" + std::to_string(kLines - lines) + " lines are missing: nobody read them)\nafterwards\n");
}

TEST(BackgroundOutput, WaitsAtItsEndForWhatIsTaken) {
  const Pipe pipe;
  BackgroundOutput(pipe.writer()).say("the last word\n");
  EXPECT_EQ(pipe.content(), "the last word\n");
}

TEST(BackgroundOutput, EndsThoughNobodyReads) {
  const Pipe pipe;
  pipe.fill();
  BackgroundOutput output(pipe.writer());
  output.say("unread\n");
}

TEST(BackgroundOutput, OutlivesItsReader) {
  Pipe pipe;
  pipe.close_reader();
  BackgroundOutput output(pipe.writer());
  for (int i = 0; i < 3; ++i) {
    output.say(line(i));
    while (!output.idle()) ::poll(nullptr, 0, 1);
  }
}

}  // namespace
}  // namespace usher::operations
