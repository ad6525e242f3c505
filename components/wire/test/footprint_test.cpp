#include "wire/footprint.hpp"

#include <gmock/gmock.h>

#include <optional>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using testing::HasSubstr;

/// What the newest Body read.
std::optional<geometry::Footprint> outline;

class Body final : public runtime::Component {
 public:
  explicit Body(runtime::Host& host) { outline = read_footprint(host); }
};

std::string error_of(const std::string& corners) {
  const Status made = runtime::TestHost::try_make(runtime::component_factory<Body>("body"),
                                                  "robot.footprint: " + corners);
  return made ? "" : made.error();
}

TEST(ReadFootprint, IsCounterClockwiseWhateverTheFileSays) {
  for (const char* corners : {"[0.3, 0.2, -0.3, 0.2, -0.3, -0.2, 0.3, -0.2]",
                              "[0.3, -0.2, -0.3, -0.2, -0.3, 0.2, 0.3, 0.2]"}) {
    ASSERT_EQ(error_of(corners), "");
    ASSERT_EQ(outline->corners().size(), 4U);
    EXPECT_DOUBLE_EQ(outline->inscribed_radius(), 0.2);
    double area = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& a = outline->corners()[i];
      const auto& b = outline->corners()[(i + 1) % 4];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
    EXPECT_NEAR(area, 0.24, 1e-12);
  }
}

TEST(ReadFootprint, RefusesWhatIsNoOutline) {
  EXPECT_THAT(error_of("[0.3, 0.2, -0.3, 0.2, -0.3, -0.2, 0.3]"), HasSubstr("pairs of x and y"));
  EXPECT_THAT(error_of("[0.3, 0.2, -0.3, 0.2, 0.1, 0.1, 0.3, -0.2]"), HasSubstr("robot.footprint"));
  EXPECT_THAT(error_of("[0.3, 0.2, 0.1, 0.2, 0.1, -0.2, 0.3, -0.2]"), HasSubstr("origin inside"));
  EXPECT_THAT(error_of("[0.3, 0.2]"), HasSubstr("robot.footprint"));
}

}  // namespace
}  // namespace usher::wire
