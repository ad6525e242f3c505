#include "wire/meeting_rooms.hpp"

#include <gmock/gmock.h>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using testing::HasSubstr;

/// What the newest Body read.
std::vector<MeetingRoom> rooms;

class Body final : public runtime::Component {
 public:
  explicit Body(runtime::Host& host) { rooms = read_meeting_rooms(host); }
};

Status read(const std::string& list) {
  return runtime::TestHost::try_make(runtime::component_factory<Body>("body"),
                                     "site.meeting_rooms: " + list);
}

TEST(ReadMeetingRooms, TakesWallsAndRefusesWhatIsNone) {
  ASSERT_TRUE(read("[{name: a, west: 0, south: 8, east: 4.5, north: 12}]").ok());
  ASSERT_EQ(rooms.size(), 1U);
  EXPECT_EQ(rooms[0].name, "a");
  EXPECT_EQ(rooms[0].low, geometry::Point2(0.0, 8.0));
  EXPECT_EQ(rooms[0].high, geometry::Point2(4.5, 12.0));
  for (const char* list : {"[{name: a, west: 5, south: 8, east: 4.5, north: 12}]",
                           "[{name: a, west: 0, south: 12, east: 4.5, north: 12}]"}) {
    const Status made = read(list);
    ASSERT_FALSE(made.ok());
    EXPECT_THAT(made.error(), HasSubstr("'a' must have west < east and south < north"));
  }
  EXPECT_TRUE(read("[]").ok());
  EXPECT_TRUE(rooms.empty());
}

}  // namespace
}  // namespace usher::wire
