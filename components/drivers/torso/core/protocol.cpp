#include "drivers/torso/core/protocol.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/serial_frame/core/fields.hpp"
#include "foundation/geometry/angle.hpp"

namespace usher::torso {

namespace {

using kinematics::EyeColor;
using kinematics::kTorsoJoints;
using serial_frame::FieldReader;
using serial_frame::FieldWriter;

enum : std::uint8_t { kSetFrame = 0x30, kState = 0x31 };

constexpr std::size_t kFrameLength = 2 + 2 * kTorsoJoints + 6;
constexpr std::size_t kStateLength = kFrameLength + 4 + 1;
constexpr double kAngleStep = geometry::kPi / 18000.0;  // [rad] 0.01 deg
constexpr double kLengthStep = 0.0001;                  // [m]
constexpr int kMostAngle = 18000, kMostLength = 10000;  // [steps]
constexpr float kFull = 255.0F;

double step_of(std::size_t joint) {
  return kinematics::is_length(joint) ? kLengthStep : kAngleStep;
}
int most_of(std::size_t joint) { return kinematics::is_length(joint) ? kMostLength : kMostAngle; }

void put_frame(FieldWriter& writer, const TorsoFrame& frame) {
  for (std::size_t i = 0; i < kTorsoJoints; ++i) {
    const double most = most_of(i);
    const double steps = std::clamp(frame.joints[i] / step_of(i), -most, most);
    writer.put(static_cast<std::int16_t>(std::lround(steps)));
  }
  for (const EyeColor& eye : {frame.left_eye, frame.right_eye}) {
    for (const float color : kinematics::dimmed(eye, 1.0))
      writer.put(static_cast<std::uint8_t>(std::lround(color * kFull)));
  }
}

std::optional<TorsoFrame> get_frame(FieldReader& reader) {
  TorsoFrame frame;
  bool possible = true;
  for (std::size_t i = 0; i < kTorsoJoints; ++i) {
    const int steps = reader.get<std::int16_t>();
    possible = possible && std::abs(steps) <= most_of(i);
    frame.joints[i] = steps * step_of(i);
  }
  for (EyeColor* eye : {&frame.left_eye, &frame.right_eye}) {
    for (float& color : *eye) color = static_cast<float>(reader.get<std::uint8_t>()) / kFull;
  }
  return possible ? std::optional(frame) : std::nullopt;
}

bool is(std::span<const std::uint8_t> content, std::uint8_t type, std::size_t length) {
  return content.size() == length && content[0] == type;
}

}  // namespace

std::optional<BoardMessage> parse(std::span<const std::uint8_t> content) {
  if (!is(content, kState, kStateLength)) return std::nullopt;
  FieldReader reader(content.subspan(1));
  BoardMessage message;
  message.sequence = reader.get<std::uint8_t>();
  message.state.time_ms = reader.get<std::uint32_t>();
  const auto frame = get_frame(reader);
  if (!frame) return std::nullopt;
  message.state.frame = *frame;
  message.state.status = reader.get<std::uint8_t>();
  return message;
}

std::optional<TorsoFrame> parse_command(std::span<const std::uint8_t> content) {
  if (!is(content, kSetFrame, kFrameLength)) return std::nullopt;
  FieldReader reader(content.subspan(2));
  return get_frame(reader);
}

serial_frame::Frame set_frame(std::uint8_t sequence, const TorsoFrame& frame) {
  FieldWriter writer(kSetFrame, sequence);
  put_frame(writer, frame);
  return writer.frame();
}

serial_frame::Frame to_frame(const BoardMessage& message) {
  FieldWriter writer(kState, message.sequence);
  writer.put(message.state.time_ms);
  put_frame(writer, message.state.frame);
  return writer.put(message.state.status).frame();
}

}  // namespace usher::torso
