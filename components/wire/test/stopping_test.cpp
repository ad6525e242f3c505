#include "wire/stopping.hpp"

#include <gmock/gmock.h>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using testing::HasSubstr;

class Base final : public runtime::Component {
 public:
  explicit Base(runtime::Host& host) { read_stopping(host); }
};

std::string error_of(const std::string& parameters) {
  const Status made =
      runtime::TestHost::try_make(runtime::component_factory<Base>("base"), parameters);
  return made ? "" : made.error();
}

TEST(ReadStopping, RefusesWhatIsNoTableAndSaysWhy) {
  EXPECT_EQ(error_of("{robot.stopping.speeds: [0.5, 1.0], robot.stopping.distances: [0.7, 1.5]}"),
            "");
  EXPECT_THAT(error_of("{robot.stopping.speeds: [0.3, 0.5, 1.0], "
                       "robot.stopping.distances: [0.7, 1.5]}"),
              HasSubstr("robot.stopping must have as many distances as speeds, got 3 in "
                        "robot.stopping.speeds and 2 in robot.stopping.distances"));
  EXPECT_THAT(error_of("{robot.stopping.speeds: [1.0, 0.5], robot.stopping.distances: [0.7, 1.5]}"),
              HasSubstr("grow from (0, 0), found (0.5"));
}

}  // namespace
}  // namespace usher::wire
