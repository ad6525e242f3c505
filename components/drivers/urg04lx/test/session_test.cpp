#include "drivers/urg04lx/core/session.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::urg04lx {
namespace {

using std::chrono::milliseconds;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

constexpr std::string_view kFacts =
    "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\n"
    "AMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";

std::string encoded(std::uint32_t value, int characters) {
  std::string text;
  for (int i = characters - 1; i >= 0; --i)
    text.push_back(static_cast<char>((value >> (6 * i) & 0x3F) + 0x30));
  return text;
}

/// A streamed scan with this time and the same range everywhere but at the first step.
std::string scan_text(std::uint32_t time, std::uint32_t first, std::uint32_t range) {
  std::string data = encoded(first, 3);
  for (int i = 1; i < 682; ++i) data += encoded(range, 3);
  std::string text = "MD0044072501000\n99b\n";
  const std::string stamp = encoded(time, 4);
  text += stamp + checksum(stamp) + "\n";
  for (std::size_t at = 0; at < data.size(); at += 64) {
    const std::string line = data.substr(at, 64);
    text += line + checksum(line) + "\n";
  }
  return text + "\n";
}

class Dialogue : public testing::Test {
 protected:
  void hear(std::string_view text) {
    session.received(bytes_of(text), now, [this](const Scan& scan) { scans.push_back(scan); });
  }
  void start() {
    session.opened(now);
    EXPECT_EQ(session.take_output(), "QT\n");
    hear("QT\n00P\n\n");
    EXPECT_EQ(session.take_output(), "SCIP2.0\n");
    hear("SCIP2.0\n0Ee\n\n");
    EXPECT_EQ(session.take_output(), "PP\n");
    hear(kFacts);
    EXPECT_EQ(session.take_output(), "MD0044072501000\n");
    hear("MD0044072501000\n00P\n\n");
    ASSERT_EQ(session.state(), Session::State::kStreaming);
  }
  Session session;
  Time now = std::chrono::seconds(100);
  std::vector<Scan> scans;
};

TEST(Scip, ChecksumsAndNumbersAreThoseOfTheSpecification) {
  EXPECT_EQ(checksum("00"), 'P');
  EXPECT_EQ(checksum("99"), 'b');
  EXPECT_EQ(checksum("02"), 'R');
  EXPECT_EQ(checksum("10"), 'Q');
  EXPECT_EQ(checksum("PROT:SCIP 2.0"), 'N');
  EXPECT_EQ(decode("0@U"), 1061U);
  EXPECT_EQ(decode("1Dm"), 5437U);
  EXPECT_EQ(decode("ZR3h"), 11149560U);
  EXPECT_FALSE(decode("0 0"));
  EXPECT_FALSE(
      decode("0\x7f"
             "0"));
}

TEST(Scip, ReadsARealAnswerWhole) {
  USHER_REQUIRE_DATA(path, "hokuyo/urg04lx_ug01_gd.scip");
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, text.size()}) {
    Reader reader;
    int answers = 0;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      reader.feed(bytes_of(std::string_view(text).substr(at, piece)), [&](const Answer& answer) {
        Scan scan;
        std::uint32_t counter = 0;
        ASSERT_TRUE(parse_scan(answer, {}, scan, counter));
        ++answers;
        EXPECT_EQ(counter, 11149560U);
        ASSERT_EQ(scan.ranges.size(), 682U);
        EXPECT_NEAR(geometry::degrees(scan.angle_min), -119.53, 0.01);
        EXPECT_NEAR(scan.ranges[24], 1.061, 1e-6);
        EXPECT_NEAR(scan.ranges[340], 0.293, 1e-6);
        EXPECT_EQ(std::count_if(scan.ranges.begin(), scan.ranges.end(),
                                [](float r) { return std::isinf(r); }),
                  53);
        EXPECT_EQ(std::count_if(scan.ranges.begin(), scan.ranges.end(),
                                [](float r) { return std::isnan(r); }),
                  32);
      });
    }
    EXPECT_EQ(answers, 1);
    EXPECT_EQ(reader.damaged(), 0U);
  }
}

TEST_F(Dialogue, StartsAndStreams) {
  start();
  EXPECT_FALSE(session.healthy());
  hear(scan_text(5000, 19, 1234));
  EXPECT_TRUE(session.healthy()) << session.reason();
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_TRUE(std::isnan(scans[0].ranges[0]));
  EXPECT_NEAR(scans[0].ranges[1], 1.234, 1e-6);
  EXPECT_NEAR(scans[0].scan_time, 0.1, 1e-12);
  EXPECT_NEAR(1e6 * scans[0].time_increment, 97.66, 0.01);
}

TEST_F(Dialogue, ALateLineDoesNotShakeTheStamps) {
  start();
  Random random(1);
  const Time began = now;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Time arrival = began + milliseconds(100 * i);
    now = arrival + milliseconds(i % 10 == 3 ? 40 : 0);
    hear(scan_text((1U << 24) - 2000 + 100 * i, 0, 1000));  // the counter wraps on the way
  }
  ASSERT_EQ(scans.size(), 100U);
  for (std::size_t i = 5; i < scans.size(); ++i) {
    const double step = std::chrono::duration<double>(scans[i].stamp - scans[i - 1].stamp).count();
    EXPECT_NEAR(step, 0.1, 0.001);
    const Time last_beam = began + milliseconds(100 * static_cast<int>(i));
    const double first = std::chrono::duration<double>(last_beam - scans[i].stamp).count();
    EXPECT_NEAR(first, 681 * 97.66e-6, 0.001) << "it said so when it had measured the last step";
  }
}

TEST_F(Dialogue, SwitchesAnOldScannerAndOneThatStreams) {
  session.opened(now);
  session.take_output();
  hear(scan_text(1, 0, 1000));  // what ran before
  EXPECT_TRUE(scans.empty());
  for (int i = 0; i < 2; ++i) {
    now += std::chrono::seconds(1);
    session.tick(now);
  }
  EXPECT_EQ(session.take_output(), "QT\nSCIP2.0\n");
  hear("SCIP2.0\n0\n\n");
  EXPECT_EQ(session.take_output(), "PP\n");
}

TEST_F(Dialogue, SaysWhyItFails) {
  session.opened(now);
  hear("QT\n00P\n\nSCIP2.0\n0Ee\n\n");
  for (int i = 0; i < 4; ++i) now += std::chrono::seconds(1), session.tick(now);
  EXPECT_EQ(session.state(), Session::State::kFailed);
  EXPECT_EQ(session.reason(), "no answer to PP");
  session.opened(now);
  hear("QT\n00P\n\nSCIP2.0\n0Ee\n\n");
  hear(kFacts);
  std::string refused = "MD0044072501000\n04";
  refused += checksum("04");
  refused += "\n\n";
  hear(refused);
  EXPECT_EQ(session.reason(), "the scanner refused MD: status 04");
}

TEST_F(Dialogue, WatchesTheScansAndStartsAnew) {
  start();
  hear(scan_text(5000, 0, 1000));
  now += milliseconds(350);
  session.tick(now);
  EXPECT_EQ(session.reason(), "scans are missing");
  now += milliseconds(1300);
  session.tick(now);
  EXPECT_EQ(session.state(), Session::State::kStopping);
  EXPECT_EQ(session.take_output(), "QT\n");
}

TEST_F(Dialogue, RejectsDamagedScansAndGoesOn) {
  start();
  std::string damaged = scan_text(5000, 0, 1000);
  damaged[200] = damaged[200] == '1' ? '2' : '1';
  hear(damaged);
  EXPECT_TRUE(scans.empty());
  EXPECT_EQ(session.rejected(), 1U);
  std::string cut = scan_text(5000, 0, 1000);
  cut.erase(200, 65);  // a whole line less
  hear(cut);
  EXPECT_TRUE(scans.empty());
  hear("\n\n" + scan_text(5100, 0, 1000));
  EXPECT_EQ(scans.size(), 1U);
}

TEST_F(Dialogue, SurvivesNoiseInEveryState) {
  Random random(7);
  for (int round = 0; round < 300; ++round) {
    session.opened(now);
    for (int i = 0; i < 50; ++i) {
      std::string noise;
      for (std::uint64_t k = random.below(300); k > 0; --k)
        noise.push_back(static_cast<char>(random.below(10) == 0 ? '\n' : random.below(256)));
      hear(noise);
      now += milliseconds(random.below(300));
      session.tick(now);
      session.take_output();
    }
    session.closed();
  }
  std::string flood(100000, 'x');
  hear(flood);
  session = Session();
  start();
}

TEST(Specification, RefusesWhatIsNoScanner) {
  const std::string_view good[] = {"DMIN:20",  "DMAX:5600", "ARES:1024", "AMIN:44",
                                   "AMAX:725", "AFRT:384",  "SCAN:600"};
  EXPECT_TRUE(parse_specification({"PP", "00", good}));
  for (std::size_t i = 0; i < std::size(good); ++i) {
    std::vector<std::string_view> lines(std::begin(good), std::end(good));
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(parse_specification({"PP", "00", lines}));
  }
  std::vector<std::string_view> lines(std::begin(good), std::end(good));
  lines[4] = "AMAX:99999999999";
  EXPECT_FALSE(parse_specification({"PP", "00", lines}));
}

}  // namespace
}  // namespace usher::urg04lx
