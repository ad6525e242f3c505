#include "drivers/lms100/core/session.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "scripted_scanner.hpp"

namespace usher::lms100 {
namespace {

using std::chrono::milliseconds;

struct Link {
  explicit Link(Dialect dialect = Dialect::kBinary) : scanner(dialect) {
    Session::Parameters parameters;
    parameters.dialect = dialect;
    session = Session(parameters);
    session.opened(now());
  }
  Scanner scanner;
  Session session;
  int now_ms = 0;
  std::vector<Scan> scans;

  Time now() const { return milliseconds(now_ms); }
  void hear(const Bytes& bytes) {
    session.received(bytes, now(), [this](const Scan& scan) { scans.push_back(scan); });
  }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      const Bytes sent = session.take_output();
      if (!sent.empty()) hear(scanner.answer(sent));
      session.tick(now());
    }
  }
};

TEST(Session, StartsInBothDialects) {
  for (const Dialect dialect : {Dialect::kAscii, Dialect::kBinary}) {
    Link link(dialect);
    link.run(5000);
    EXPECT_EQ(link.session.state(), Session::State::kStreaming) << link.session.reason();
    link.hear(link.scanner.scan(1, 1000));
    ASSERT_EQ(link.scans.size(), 1U);
    EXPECT_TRUE(link.session.healthy());
    EXPECT_FLOAT_EQ(link.scans[0].ranges[0], 1.0F);
    EXPECT_FLOAT_EQ(link.scans[0].ranges[3], 2.0F);
    EXPECT_EQ(link.scans[0].stamp, link.now() - std::chrono::microseconds(3000));
  }
}

TEST(Session, SaysWhatTheRecordedDialogueSays) {
  Link link(Dialect::kAscii);
  link.run(5000);
  const std::vector<std::string> expected{
      "sMN SetAccessMode 3 F4724744",
      "sMN mLMPsetscancfg 1388 1 1388 FFF92230 225510",
      "sWN LMDscandatacfg 1 0 0 1 0 0 0 0 0 0 0 1",
      "sWN LMPoutputRange 1 1388 FFF92230 225510",
      "sMN LMCstartmeas",
      "sMN Run",
      "sRN STlms",
      "sRN STlms",
      "sRN STlms",
      "sRN STlms",
      "sEN LMDscandata 1",
  };
  EXPECT_EQ(link.scanner.heard, expected);
}

TEST(Session, SaysWhyItFails) {
  struct Row {
    void (*spoil)(Scanner&);
    const char* reason;
  };
  const Row rows[] = {
      {[](Scanner& s) { s.refuse_login = true; }, "the scanner refused the login"},
      {[](Scanner& s) { s.refuse_settings_with = 1; },
       "the scanner refused mLMPsetscancfg: frequency not allowed"},
      {[](Scanner& s) { s.refuse_settings_with = 5; },
       "the scanner refused mLMPsetscancfg: refused"},
      {[](Scanner& s) { s.refuse_with_error = "LMPoutputRange"; },
       "the scanner refused LMPoutputRange: unknown variable"},
      {[](Scanner& s) { s.refuse_with_error = "STlms"; },
       "the scanner refused STlms: unknown variable"},
      {[](Scanner& s) { s.mute = "Run"; }, "no answer to Run"},
      {[](Scanner& s) { s.mute = "LMDscandata"; }, "no answer to sEN LMDscandata"},
      {[](Scanner& s) { s.polls_until_ready = 1000; }, "the scanner does not begin to measure"},
  };
  for (const Row& row : rows) {
    for (const Dialect dialect : {Dialect::kAscii, Dialect::kBinary}) {
      Link link(dialect);
      row.spoil(link.scanner);
      link.run(130000);
      EXPECT_EQ(link.session.state(), Session::State::kFailed);
      EXPECT_EQ(link.session.reason(), row.reason);
    }
  }
}

TEST(Session, WatchesTheScans) {
  Link link;
  link.run(5000);
  for (std::uint16_t i = 1; i <= 10; ++i) {
    link.now_ms += 20;
    link.hear(link.scanner.scan(i, i * 20000U));
  }
  EXPECT_EQ(link.session.scans(), 10U);
  link.run(150);
  EXPECT_TRUE(link.session.healthy());
  link.run(100);
  EXPECT_FALSE(link.session.healthy());
  EXPECT_EQ(link.session.reason(), "scans are missing");
  link.hear(link.scanner.scan(20, 400000));
  EXPECT_TRUE(link.session.healthy());
  EXPECT_EQ(link.session.lost_scans(), 9U);
  link.run(2000);
  EXPECT_EQ(link.session.state(), Session::State::kFailed);
  EXPECT_EQ(link.session.reason(), "no scans");
  link.session.opened(link.now());
  link.scanner.polls_until_ready = 0;
  link.run(1000);
  EXPECT_EQ(link.session.state(), Session::State::kStreaming);
}

TEST(Session, TrustsNoScanOfADeviceWithAnError) {
  Link link;
  link.run(5000);
  std::uint16_t counter = 0;
  const auto hear = [&](std::uint8_t status) {
    link.scanner.device_status = status;
    ++counter;
    link.hear(link.scanner.scan(counter, counter * 20000U));
    return link.scans.size();
  };
  EXPECT_EQ(hear(0), 1U);
  EXPECT_TRUE(link.session.healthy());
  EXPECT_EQ(hear(1), 1U);
  EXPECT_EQ(link.session.reason(), "the scanner reports an error");
  EXPECT_EQ(hear(2), 2U) << "a dirty window still measures";
  EXPECT_EQ(link.session.reason(), "the scanner's window is dirty");
  EXPECT_EQ(hear(4), 2U);
  EXPECT_EQ(hear(5), 2U);
  EXPECT_FALSE(link.session.healthy());
  for (const int status : {3, 6, 128, 255}) {
    EXPECT_EQ(hear(static_cast<std::uint8_t>(status)), 2U);
    EXPECT_EQ(link.session.reason(), "the scanner reports status " + std::to_string(status));
  }
  EXPECT_EQ(hear(0), 3U);
  EXPECT_TRUE(link.session.healthy());
}

TEST(Session, IgnoresARepeatedScanAndSurvivesTheCountersWrap) {
  Link link;
  link.run(5000);
  link.hear(link.scanner.scan(65535, 20000));
  link.hear(link.scanner.scan(65535, 20000));
  link.hear(link.scanner.scan(0, 40000));
  EXPECT_EQ(link.scans.size(), 2U);
  EXPECT_EQ(link.session.lost_scans(), 0U);
}

TEST(Session, EventsInBetweenAndOldScansDoNotDisturb) {
  Link link;
  link.hear(link.scanner.scan(5, 1000));  // of a subscription that nobody ended
  link.hear(Command(Dialect::kBinary, "sSN", "LIDoutputstate").number(0, 4).frame());
  link.hear(Command(Dialect::kBinary, "sEA", "LIDinputstate").number(1, 1).frame());
  link.run(5000);
  EXPECT_EQ(link.session.state(), Session::State::kStreaming);
  EXPECT_TRUE(link.scans.empty());
}

TEST(Session, RejectsBrokenScansAndGoesOn) {
  Link link;
  link.run(5000);
  link.hear(Command(Dialect::kBinary, "sSN", "LMDscandata").number(1, 2).frame());
  EXPECT_EQ(link.session.rejected(), 1U);
  link.hear(link.scanner.scan(1, 1000));
  EXPECT_EQ(link.scans.size(), 1U);
}

TEST(Session, SurvivesNoiseInEveryState) {
  Random random(8);
  for (int run = 0; run < 200; ++run) {
    Link link(run % 2 == 0 ? Dialect::kAscii : Dialect::kBinary);
    link.run(static_cast<int>(random.below(6000)));
    for (int i = 0; i < 20; ++i) {
      Bytes noise(random.below(300));
      for (auto& byte : noise) byte = static_cast<std::uint8_t>(random.below(256));
      link.hear(noise);
    }
    link.session.closed();
    link.session.opened(link.now());
    link.scanner.polls_until_ready = 0;
    link.run(2000);
    EXPECT_EQ(link.session.state(), Session::State::kStreaming) << link.session.reason();
  }
}

}  // namespace
}  // namespace usher::lms100
