#include "operations/command_line/meeting_client.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <thread>

namespace usher::operations {
namespace {

using usher_msgs::msg::MeetingStatus;
namespace state = usher_msgs::msg::MeetingStatus_Constants;

MeetingStatus answer(std::uint64_t request, const std::string& client, std::uint64_t mission,
                     const std::string& reason = {}) {
  MeetingStatus status;
  status.last_request(request);
  status.last_client(client);
  status.reason(reason);
  status.mission().id(mission);
  status.mission().client(client);
  return status;
}

TEST(MeetingCall, RepeatsItselfUntilItIsAnswered) {
  MeetingCall call(3, 120.0);
  const auto first = call.due();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->persons(), 3U);
  EXPECT_EQ(first->time_limit(), 120.0F);
  EXPECT_FALSE(call.due()) << "at 5 Hz";
  std::this_thread::sleep_for(std::chrono::milliseconds(210));
  const auto again = call.due();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->id(), first->id());
  call.take(answer(call.id(), "operator", call.id()));
  EXPECT_TRUE(call.taken());
  std::this_thread::sleep_for(std::chrono::milliseconds(210));
  EXPECT_FALSE(call.due());
}

TEST(MeetingCall, TakesOnlyItsOwnAnswer) {
  MeetingCall call(1, 0.0);
  call.take(answer(7, "tablet", 7, "request 7 refused"));
  call.take(answer(call.id(), "tablet", call.id()));
  EXPECT_FALSE(call.taken());
  EXPECT_EQ(call.refusal(), "");
  call.take(answer(call.id(), "operator", 5, "request refused: no map"));
  EXPECT_FALSE(call.taken());
  EXPECT_EQ(call.refusal(), "request refused: no map");
  EXPECT_FALSE(call.due());
}

TEST(MeetingProgress, SaysWhatItDoes) {
  MeetingStatus status;
  status.state(state::STATE_GUIDE);
  status.mission().room("meeting_room_1");
  status.mission().wanted(2);
  status.mission().brought(1);
  status.time_left(61.4F);
  EXPECT_EQ(meeting_progress(status),
            "brings a person to the room, meeting in meeting_room_1, 1 of 2 there, 61 s left");
  status.state(200);
  status.time_left(std::numeric_limits<float>::quiet_NaN());
  status.reason("no map");
  EXPECT_EQ(meeting_progress(status), "?, meeting in meeting_room_1, 1 of 2 there: no map");
}

}  // namespace
}  // namespace usher::operations
