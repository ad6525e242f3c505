#include "runtime/guard/guard.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace usher::runtime {
namespace {

using std::chrono::milliseconds;
using Time = Guard::Time;

constexpr std::string_view kSafe = "0.";

Time at(int ms) { return milliseconds(1000 + ms); }

/// A guard, and a port that has taken everything so far.
struct Bench {
  Guard guard{std::vector<std::uint8_t>(kSafe.begin(), kSafe.end()), milliseconds(100)};
  bool hear(std::string_view text, int ms) {
    return guard.heard(Outbox::Kind::kEach,
                       {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, at(ms));
  }
  std::string take(std::size_t most = 100) {
    const auto output = guard.output();
    const std::string text(output.begin(), output.begin() + static_cast<std::ptrdiff_t>(
                                                                std::min(most, output.size())));
    guard.sent(text.size());
    return text;
  }
  std::string tick(int ms) {
    guard.tick(at(ms));
    return take();
  }
};

TEST(Guard, PassesWhatTheDriverWrites) {
  Bench bench;
  bench.hear("abc", 0);
  bench.hear("de", 10);
  EXPECT_EQ(bench.take(), "abcde");
  EXPECT_EQ(bench.tick(109), "");
  EXPECT_FALSE(bench.guard.overruling());
}

TEST(Guard, SaysNothingMoreBeforeTheDriverDoes) {
  Bench bench;
  EXPECT_FALSE(bench.guard.due());
  EXPECT_EQ(bench.tick(100000), "");
  bench.guard.gone(at(100001));
  EXPECT_TRUE(bench.guard.finished());
  EXPECT_EQ(bench.take(), "");
}

TEST(Guard, GreetsThePortWithWhatIsSafe) {
  Bench bench;
  bench.guard.greet();
  EXPECT_FALSE(bench.guard.due());
  EXPECT_EQ(bench.take(3), "0.0") << "twice";
  bench.guard.heard(Outbox::Kind::kLatest, std::vector<std::uint8_t>{'g', 'o'}, at(0));
  EXPECT_EQ(bench.take(), ".go") << "no velocity takes their place";
  Bench brief;
  brief.guard.greet();
  brief.guard.gone(at(0));
  EXPECT_FALSE(brief.guard.finished());
  EXPECT_EQ(brief.take(), "0.0.");
  EXPECT_TRUE(brief.guard.finished());
}

TEST(Guard, OverrulesASilentDriverUntilItWrites) {
  Bench bench;
  bench.hear("go", 0);
  EXPECT_EQ(bench.take(), "go");
  EXPECT_EQ(bench.guard.due(), at(100));
  EXPECT_EQ(bench.tick(99), "");
  EXPECT_EQ(bench.tick(100), "0.");
  EXPECT_TRUE(bench.guard.overruling());
  EXPECT_EQ(bench.tick(133), "");
  EXPECT_EQ(bench.tick(134), "0.") << "three times in a silence";
  EXPECT_EQ(bench.tick(500), "0.");
  bench.hear("go", 505);
  EXPECT_EQ(bench.tick(510), "go");
  EXPECT_FALSE(bench.guard.overruling());
  EXPECT_EQ(bench.tick(605), "0.");
}

TEST(Guard, SendsTheWillOfASilentDriverBeforeWhatIsSafe) {
  Bench bench;
  const auto will = [&](std::string_view text, int lasts) {
    bench.guard.will({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                     milliseconds(lasts));
  };
  bench.hear("go", 0);
  will("left.", 150);
  EXPECT_EQ(bench.take(), "go");
  EXPECT_EQ(bench.tick(100), "left.");
  EXPECT_EQ(bench.tick(134), "left.");
  EXPECT_EQ(bench.tick(249), "left.");
  EXPECT_EQ(bench.tick(283), "0.");
  bench.hear("go", 300);
  EXPECT_EQ(bench.take(), "go");
  EXPECT_EQ(bench.tick(400), "left.") << "it counts anew";
  will("right.", 150);
  EXPECT_EQ(bench.tick(434), "right.") << "a will is no sign of life, and the newest counts";
  bench.hear("go", 450);
  will("", 150);
  bench.take();
  EXPECT_EQ(bench.tick(550), "0.") << "none any more";
  bench.hear("go", 600);
  will(std::string(300, 'x'), 150);
  bench.take();
  EXPECT_EQ(bench.tick(700), "0.") << "longer than any";
}

/// A driver that left a will of a second and was heard last at 0 ms.
Bench willed() {
  Bench bench;
  bench.hear("go", 0);
  bench.guard.will(std::vector<std::uint8_t>{'w'}, milliseconds(1000));
  bench.take();
  return bench;
}

TEST(Guard, SendsTheWillOfADriverThatEndedBeforeItSaysFarewell) {
  Bench bench = willed();
  bench.guard.gone(at(3));
  EXPECT_EQ(bench.take(), "w") << "at once";
  EXPECT_EQ(bench.guard.farewell_at(), at(1003));
  std::string heard;
  for (int ms = 4; ms < 1003; ++ms) heard += bench.tick(ms);
  EXPECT_EQ(heard, std::string(29, 'w')) << "three times in a silence";
  for (const int ms : {1003, 1013, 1023}) EXPECT_EQ(bench.tick(ms), "0.");
  EXPECT_TRUE(bench.guard.finished());

  Bench silent = willed();
  EXPECT_EQ(silent.tick(100), "w");
  silent.guard.gone(at(800));
  EXPECT_EQ(silent.take(), "w");
  EXPECT_EQ(silent.guard.farewell_at(), at(1100)) << "it was silent before";
  Bench longer = willed();
  longer.tick(100);
  longer.guard.gone(at(2000));
  EXPECT_EQ(longer.take(), "0.");
}

TEST(Guard, TheNextOneDecides) {
  Bench bench = willed();
  bench.guard.port_wanted(at(1));
  EXPECT_EQ(bench.take(), "") << "nobody succeeds a driver that lives";
  bench.guard.gone(at(3));
  EXPECT_EQ(bench.take(), "w");
  bench.guard.port_wanted(at(5));
  bench.guard.port_wanted(at(6));
  EXPECT_EQ(bench.take(), "0.");
  for (const int ms : {15, 25}) EXPECT_EQ(bench.tick(ms), "0.");
  EXPECT_TRUE(bench.guard.finished());
}

TEST(Guard, AnEmptyMessageIsALifeSignToo) {
  Bench bench;
  bench.hear("go", 0);
  bench.hear("", 90);
  EXPECT_EQ(bench.tick(150), "go");
}

TEST(Guard, SaysFarewellThreeTimesAndEnds) {
  Bench bench;
  bench.hear("go", 0);
  bench.take();
  bench.guard.gone(at(3));
  EXPECT_EQ(bench.take(), "0.") << "at once";
  EXPECT_FALSE(bench.guard.finished());
  EXPECT_EQ(bench.tick(13), "0.");
  bench.guard.tick(at(23));
  EXPECT_FALSE(bench.guard.finished()) << "the last one is not sent yet";
  EXPECT_EQ(bench.take(), "0.");
  EXPECT_TRUE(bench.guard.finished());
  EXPECT_FALSE(bench.guard.due());
}

TEST(Guard, DropsWhatWaitsButNoPartOfAMessage) {
  Bench bench;
  bench.hear("first", 0);
  bench.hear("second", 1);
  bench.hear("third", 2);
  EXPECT_EQ(bench.take(7), "firstse");
  bench.guard.gone(at(3));
  EXPECT_EQ(bench.take(3), "con");
  bench.guard.tick(at(13));
  EXPECT_EQ(bench.take(2), "d0") << "the safe message that waited is not doubled";
  EXPECT_EQ(bench.tick(23), ".0.");
  EXPECT_TRUE(bench.guard.finished());
}

TEST(Guard, DropsWhatWaitsWhenNothingIsUnderWay) {
  Bench bench;
  bench.hear("first", 0);
  bench.hear("second", 1);
  bench.guard.gone(at(3));
  EXPECT_EQ(bench.take(), "0.");
}

TEST(Guard, TheNewestVelocityTakesThePlaceOfTheOlder) {
  Bench bench;
  const auto latest = [&](std::string_view text, int ms) {
    bench.guard.heard(Outbox::Kind::kLatest,
                      {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, at(ms));
  };
  bench.hear("setting ", 0);
  for (int ms = 0; ms < 90; ++ms) latest("fast ", ms);
  latest("slow ", 90);
  EXPECT_EQ(bench.take(), "setting slow ") << "the port was blocked meanwhile";
}

TEST(Guard, RefusesMoreThanItsBounds) {
  Bench bench;
  const std::string big(30000, 'x');
  EXPECT_TRUE(bench.hear(big, 0));
  EXPECT_TRUE(bench.hear(big, 0));
  EXPECT_FALSE(bench.hear(big, 0));
  Bench many;
  for (std::size_t i = 0; i < Outbox::kMostMessages; ++i) EXPECT_TRUE(many.hear("x", 0));
  EXPECT_FALSE(many.hear("x", 0));
}

// From whatever the driver did, the port hears only safe messages from `silence` after its last
// write on, and every message whole.
TEST(Guard, KeepsItsPromiseForEveryLengthOfSilence) {
  for (int pause = 1; pause < 400; ++pause) {
    Bench bench;
    std::string heard;
    int last_go = -1, first_safe = -1;
    for (int ms = 0; ms < pause + 300; ++ms) {
      if (ms % 10 == 0 && (ms < 100 || ms >= 100 + pause)) bench.hear("go", ms);
      const std::string got = bench.tick(ms);
      heard += got;
      if (got.find("go") != std::string::npos && ms < 100) last_go = ms;
      if (got.find("0.") != std::string::npos && first_safe < 0) first_safe = ms;
    }
    for (std::size_t i = 0; i < heard.size(); i += 2) {
      const std::string word = heard.substr(i, 2);
      ASSERT_TRUE(word == "go" || word == "0.") << "pause " << pause << ": " << heard;
    }
    const int next_go = (100 + pause + 9) / 10 * 10;
    if (next_go - last_go > 100) {
      ASSERT_EQ(first_safe, last_go + 100) << "pause " << pause;
    } else {
      ASSERT_EQ(first_safe, -1) << "pause " << pause;
    }
  }
}

}  // namespace
}  // namespace usher::runtime
