#include "operations/command_line/usage.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace usher::operations {
namespace {

/// A program with two commands, and what it says of a command line.
class Usage : public testing::Test {
 protected:
  Usage() : app_("A program", "usher") {
    app_.require_subcommand(1);
    app_.fallthrough();
    app_.add_option("--keys", keys_);
    CLI::App* drive = app_.add_subcommand("drive", "Drives");
    drive->add_option("place", place_)->required();
    drive->add_option("--speed", speed_)->check(within(0, 1.5));
    app_.add_subcommand("status", "Says how it is");
  }

  std::optional<int> run(std::vector<const char*> words) {
    words.insert(words.begin(), "usher");
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const auto code = ended_by(app_, static_cast<int>(words.size()), words.data());
    output_ = testing::internal::GetCapturedStdout();
    errors_ = testing::internal::GetCapturedStderr();
    return code;
  }

  CLI::App app_;
  std::string keys_, place_, output_, errors_;
  double speed_ = 0.0;
};

TEST_F(Usage, LetsAGoodCommandLineGoOn) {
  EXPECT_EQ(run({"drive", "kitchen", "--speed", "1.5"}), std::nullopt);
  EXPECT_EQ(errors_ + output_, "");
  EXPECT_EQ(speed_, 1.5);
}

TEST_F(Usage, EndsWithZeroAfterHelp) {
  EXPECT_EQ(run({"drive", "--help"}), 0);
  EXPECT_THAT(output_, testing::HasSubstr("--speed"));
  EXPECT_EQ(errors_, "");
}

TEST_F(Usage, EndsWithTwoAfterEveryWrongUse) {
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(errors_, "usher: A subcommand is required; see usher --help\n");
  EXPECT_EQ(run({"drive"}), 2);
  EXPECT_EQ(errors_, "usher: place is required; see usher drive --help\n");
  EXPECT_EQ(run({"statsu"}), 2);
  EXPECT_EQ(errors_, "usher: unknown command 'statsu'; see usher --help; did you mean status?\n");
  EXPECT_EQ(run({"drive", "kitchen", "--spede", "1"}), 2);
  EXPECT_EQ(errors_,
            "usher: unknown option --spede; see usher drive --help; did you mean --speed?\n");
  EXPECT_EQ(run({"drive", "--kesy=x"}), 2) << "also where something is missing";
  EXPECT_EQ(errors_,
            "usher: unknown option --kesy; see usher drive --help; did you mean --keys?\n");
  EXPECT_EQ(run({"status", "now"}), 2);
  EXPECT_EQ(errors_, "usher: unexpected 'now'; see usher status --help\n");
}

TEST_F(Usage, EndsWithTwoAfterAWrongNumber) {
  for (const char* wrong : {"1.51", "-0.1", "nan", "inf", "x", "1x", ""}) {
    EXPECT_EQ(run({"drive", "kitchen", "--speed", wrong}), 2) << wrong;
    EXPECT_EQ(errors_, std::string("usher: --speed: must be in [0, 1.5], got '") + wrong +
                           "'; see usher drive --help\n");
  }
}

TEST(DomainNumber, IsOneOfDds) {
  const auto domain = domain_number();
  EXPECT_EQ(domain("0"), "");
  EXPECT_EQ(domain("232"), "");
  EXPECT_EQ(domain("233"), "must be in [0, 232], got '233'");
  EXPECT_NE(domain("-1"), "");
}

}  // namespace
}  // namespace usher::operations
