// The driver that plays a recording, as it does by default.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "drivers/kinect/device_real/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "support/folder.hpp"

namespace usher::kinect {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class RecordedKinectTest : public testing::Test {
 protected:
  /// An image of a Kinect v2 that measures 2 m everywhere, or half of it.
  void add(const std::string& name, bool whole = true) {
    std::string bytes = "P5 512 424 65535\n";
    for (int pixel = 0; pixel < 512 * 424 / (whole ? 1 : 2); ++pixel)
      bytes += {static_cast<char>(2000 >> 8), static_cast<char>(2000 & 0xff)};
    folder.file(name, bytes);
  }
  void start(const std::string& more = {}) {
    host.emplace(runtime::component_factory<KinectComponent>("kinect"),
                 "recording: " + folder.path() + more);
  }
  std::size_t played() { return host->written(topics::kKinectDepth).size(); }

  test::Folder folder;
  std::optional<runtime::TestHost> host;
};

TEST_F(RecordedKinectTest, WaitsForImagesAndSaysWhatItLooksFor) {
  start();
  host->run_for(milliseconds(500));
  EXPECT_THAT(host->heartbeat().reason(), HasSubstr("no depth images"));
  add("a.pgm");
  host->run_for(milliseconds(2500));
  EXPECT_GT(played(), 0U);
  EXPECT_EQ(host->heartbeat().reason(), "");
}

TEST_F(RecordedKinectTest, CountsAnImageThatIsNoneAndPlaysTheNext) {
  add("a.pgm");
  add("b.pgm", false);
  add("c.pgm");
  start("\nrepeat: false");
  host->run_for(milliseconds(1000));
  EXPECT_EQ(played(), 2U);
  EXPECT_EQ(host->counter("frames: rejected"), 1U);
  EXPECT_EQ(host->heartbeat().reason(), "");
}

TEST_F(RecordedKinectTest, BeginsAnewAtTheEnd) {
  add("a.pgm");
  add("b.pgm");
  start();
  host->run_for(milliseconds(1000));
  EXPECT_GT(played(), 10U);
}

}  // namespace
}  // namespace usher::kinect
