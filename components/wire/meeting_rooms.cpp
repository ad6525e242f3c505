#include "wire/meeting_rooms.hpp"

namespace usher::wire {

std::vector<MeetingRoom> read_meeting_rooms(runtime::Host& host) {
  const auto wall = [](const char* name, const char* text) {
    return runtime::RecordField{name, runtime::ParameterKind::kNumber, "m", {-1e4, 1e4}, text};
  };
  const auto records = host.parameters().records(
      "site.meeting_rooms",
      {{"name", runtime::ParameterKind::kText, "-", {}, "Of the location where the robot turns."},
       wall("west", "Of its walls, in map."),
       wall("south", "The same."),
       wall("east", "The same."),
       wall("north", "The same.")},
      "Rooms in which nobody is looked for: the robot brings people there.");
  std::vector<MeetingRoom> rooms;
  rooms.reserve(records.size());
  for (const auto& record : records) {
    const MeetingRoom room{record.text("name"),
                           {record.number("west"), record.number("south")},
                           {record.number("east"), record.number("north")}};
    if (!(room.low.array() < room.high.array()).all())
      host.fault("site.meeting_rooms: '" + room.name + "' must have west < east and south < north");
    rooms.push_back(room);
  }
  return rooms;
}

}  // namespace usher::wire
