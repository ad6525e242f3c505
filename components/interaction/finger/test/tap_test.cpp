#include "interaction/finger/core/tap.hpp"

#include <gtest/gtest.h>

namespace usher::finger {
namespace {

std::vector<Tap> take(Lines& lines, const std::string& text) {
  return lines.take({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Tap, ComesBackAsItWas) {
  const std::vector<Tap> taps{{17, false, "language:en"},
                              {18446744073709551615U, false, "a place with spaces"},
                              {3, true, " "}};
  std::string text;
  for (const auto& tap : taps) text += to_line(tap);
  Lines whole;
  EXPECT_EQ(take(whole, text), taps);
  Lines parts;
  std::vector<Tap> got;
  for (const char letter : text) {
    for (auto& tap : take(parts, {letter})) got.push_back(std::move(tap));
  }
  EXPECT_EQ(got, taps) << "wherever the stream cuts them";
  EXPECT_EQ(whole.rejected() + parts.rejected(), 0U);
}

TEST(Tap, LeavesOutWhatMakesNoSense) {
  Lines lines;
  const std::string endless(100000, 'x');
  EXPECT_TRUE(take(lines, "yes\n17 yes\n17 button \n-1 button yes\n\n" + endless + "\n").empty());
  EXPECT_EQ(lines.rejected(), 6U);
  EXPECT_TRUE(take(lines, "1 button " + std::string(kLongestTarget + 1, 'x') + "\n").empty());
  EXPECT_EQ(take(lines, "1 button yes\n"), (std::vector<Tap>{{1, false, "yes"}}));
}

TEST(Tap, ForgetsHalfALineOfSomebodyElse) {
  Lines lines;
  EXPECT_TRUE(take(lines, "1 button n").empty());
  lines.restart();
  EXPECT_EQ(take(lines, "1 button yes\n"), (std::vector<Tap>{{1, false, "yes"}}));
}

}  // namespace
}  // namespace usher::finger
