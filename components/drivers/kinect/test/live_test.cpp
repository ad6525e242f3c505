// The driver of a live Kinect v1 against libfreenect's own stand-in for the device (fakenect, which
// LD_LIBRARY_PATH puts in the library's place): it plays a recording, 11 bits as the sensor
// measures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "drivers/kinect/core/camera_model.hpp"
#include "drivers/kinect/device_real/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::kinect {
namespace {

using std::chrono::milliseconds;

constexpr int kRaw = 800;

/// Ten moments, 33 ms apart; the device's clock says of the colors that they came long before.
void record(const test::Folder& folder) {
  std::string index;
  for (int i = 0; i < 10; ++i) {
    std::string time = "-1.";
    time += std::to_string(100 + 33 * i);
    time += "000-";
    const std::string ticks = std::to_string(2'000'000 * (i + 1));
    std::string depth = "P5 640 480 65535\n", color = "P6 640 480 255\n";
    for (int pixel = 0; pixel < 640 * 480; ++pixel) {
      depth += static_cast<char>(kRaw & 0xff);
      depth += static_cast<char>(kRaw >> 8);
      color += {10, 20, 30};
    }
    for (const auto& [kind, bytes] : {std::pair("d", &depth), std::pair("r", &color)}) {
      std::string name = kind;
      name += time;
      name += *kind == 'd' ? ticks : "1";
      name += *kind == 'd' ? ".pgm" : ".ppm";
      folder.file(name, *bytes);
      index += name;
      index += "\n";
    }
  }
  folder.file("INDEX.txt", index);
}

bool is_fake() {
  const char* libraries = std::getenv("LD_LIBRARY_PATH");
  return libraries != nullptr && std::string(libraries).find("fakenect") != std::string::npos;
}

// One test: fakenect plays only once in a process.
TEST(LiveKinectTest, DeliversDepthAndColorOfBeforeTheyCameAndSaysThatAReadLasts) {
  if (!is_fake()) GTEST_SKIP() << "ctest puts libfreenect's fakenect in LD_LIBRARY_PATH";
  const test::Folder folder;
  record(folder);
  setenv("FAKENECT_PATH", folder.path().c_str(), 1);
  const runtime::ComponentFactory slow{"kinect", [](runtime::Host& host) {
                                         return std::make_unique<KinectComponent>(
                                             host, milliseconds(500));
                                       }};
  runtime::TestHost host(slow, "robot.kinect.model: v1\nsource: live\nvalues: raw_11_bit");
  const runtime::Time start = host.now();
  host.run_for(milliseconds(250));
  EXPECT_EQ(host.heartbeat().reason(), "");
  host.run_for(milliseconds(200));
  EXPECT_EQ(host.heartbeat().reason(), "the Kinect is silent: a read takes over 0.3 s");
  host.run_for(milliseconds(200));
  const auto depth = host.last(topics::kKinectDepth);
  const auto color = host.last(topics::kKinectColor);
  ASSERT_TRUE(depth && color) << host.heartbeat().reason();
  EXPECT_EQ(depth->header().stamp().nanosec(), color->header().stamp().nanosec());
  const auto stamp = wire::from_message(depth->header().stamp()) - start;
  EXPECT_NEAR(runtime::seconds(stamp), 0.505 - 0.033, 0.001) << "it was read from 5 ms on";
  EXPECT_EQ(depth->width(), 640U);
  EXPECT_EQ(depth->data()[0] + 256 * depth->data()[1], millimeters_of_raw(kRaw));
  EXPECT_EQ(color->encoding(), "rgb8");
  EXPECT_THAT(std::vector<int>(color->data().begin(), color->data().begin() + 3),
              testing::ElementsAre(10, 20, 30));
  EXPECT_EQ(host.last(topics::kKinectInfo)->k()[0], kinect_v1().fx);
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST(LiveKinectTest, EndsWhenAReadHangsSoThatAnotherProcessReadsOn) {
  const runtime::ComponentFactory hanging{"kinect", [](runtime::Host& host) {
                                            return std::make_unique<KinectComponent>(
                                                host, std::chrono::hours(1));
                                          }};
  runtime::TestHost host(hanging, "source: live");
  host.run_for(milliseconds(4900));
  EXPECT_TRUE(host.running());
  EXPECT_EQ(host.heartbeat().reason(), "the Kinect is silent: a read takes over 0.3 s");
  host.run_for(milliseconds(200));
  EXPECT_FALSE(host.running());
  EXPECT_EQ(host.fault_reason(), "the Kinect hangs: a read takes over 5 s");
}

TEST(LiveKinectTest, RefusesAnIncompleteLens) {
  try {
    const runtime::TestHost host(runtime::component_factory<KinectComponent>("kinect"),
                                 "source: live\nrobot.kinect.intrinsics: [365, 365, 256]");
    FAIL() << "it started";
  } catch (const std::exception& error) {
    EXPECT_STREQ(error.what(),
                 "robot.kinect.intrinsics: expected fx, fy, cx, cy or nothing, got 3 values");
  }
}

TEST(LiveKinectTest, SaysWhatIsMissing) {
  if (is_fake()) GTEST_SKIP() << "against the library itself";
  runtime::TestHost host(runtime::component_factory<KinectComponent>("kinect"),
                         "robot.kinect.model: v2\nsource: live");
  host.run_for(milliseconds(2500));
  if (host.last(topics::kKinectDepth)) GTEST_SKIP() << "a Kinect is connected";
  EXPECT_THAT(host.heartbeat().reason(), testing::HasSubstr("no Kinect v1 at the USB"));
  EXPECT_EQ(host.counter("frames: rejected"), 3U) << "looked for once a second";
}

}  // namespace
}  // namespace usher::kinect
