#include "drivers/sensor_board/core/protocol.hpp"

#include "drivers/serial_frame/core/fields.hpp"

namespace usher::sensor_board {

namespace {

using serial_frame::FieldReader;
using serial_frame::FieldWriter;

enum : std::uint8_t {
  kSensors = 0x10,
  kWhisker = 0x11,
  kSetTilt = 0x20,
  kSetConfig = 0x22,
  kAck = 0x60,
  kNack = 0x61,
};

std::size_t length_of(std::uint8_t type) {
  switch (type) {
    case kSensors:
      return 20;
    case kWhisker:
      return 8;
    case kAck:
      return 4;
    case kNack:
      return 5;
    default:
      return 0;
  }
}

}  // namespace

std::optional<BoardMessage> parse(std::span<const std::uint8_t> content) {
  if (content.size() < 2 || content.size() != length_of(content[0])) return std::nullopt;
  FieldReader reader(content);
  const auto type = reader.get<std::uint8_t>();
  BoardMessage message;
  message.sequence = reader.get<std::uint8_t>();
  switch (type) {
    case kSensors: {
      Sensors sensors;
      sensors.time_ms = reader.get<std::uint32_t>();
      for (auto& range : sensors.ranges_mm) range = reader.get<std::uint16_t>();
      sensors.whisker_mask = reader.get<std::uint8_t>();
      sensors.tilt = reader.get<std::int16_t>();
      sensors.status = reader.get<std::uint8_t>();
      message.content = sensors;
      return message;
    }
    case kWhisker: {
      WhiskerChange change;
      change.time_ms = reader.get<std::uint32_t>();
      change.mask = reader.get<std::uint8_t>();
      change.changed = reader.get<std::uint8_t>();
      message.content = change;
      return message;
    }
    default: {
      Verdict verdict;
      verdict.accepted = type == kAck;
      verdict.type = reader.get<std::uint8_t>();
      verdict.sequence = reader.get<std::uint8_t>();
      if (!verdict.accepted) verdict.reason = reader.get<std::uint8_t>();
      message.content = verdict;
      return message;
    }
  }
}

Frame set_tilt(std::uint8_t sequence, std::int16_t tilt) {
  return FieldWriter(kSetTilt, sequence).put(tilt).frame();
}

Frame set_config(std::uint8_t sequence, std::uint8_t key, std::int32_t value) {
  return FieldWriter(kSetConfig, sequence).put(key).put(value).frame();
}

Frame to_frame(const BoardMessage& message) {
  const std::uint8_t sequence = message.sequence;
  if (const auto* sensors = std::get_if<Sensors>(&message.content)) {
    FieldWriter writer(kSensors, sequence);
    writer.put(sensors->time_ms);
    for (const std::uint16_t range : sensors->ranges_mm) writer.put(range);
    return writer.put(sensors->whisker_mask).put(sensors->tilt).put(sensors->status).frame();
  }
  if (const auto* change = std::get_if<WhiskerChange>(&message.content)) {
    return FieldWriter(kWhisker, sequence)
        .put(change->time_ms)
        .put(change->mask)
        .put(change->changed)
        .frame();
  }
  const auto& verdict = std::get<Verdict>(message.content);
  FieldWriter writer(verdict.accepted ? kAck : kNack, sequence);
  writer.put(verdict.type).put(verdict.sequence);
  if (!verdict.accepted) writer.put(verdict.reason);
  return writer.frame();
}

}  // namespace usher::sensor_board
