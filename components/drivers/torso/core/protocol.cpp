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

enum : std::uint8_t { kHello = 0x01, kHeartbeat = 0x21, kSetFrame = 0x30, kState = 0x31 };

constexpr std::size_t kHelloLength = 12;
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
  const bool hello = is(content, kHello, kHelloLength);
  if (!hello && !is(content, kState, kStateLength)) return std::nullopt;
  FieldReader reader(content.subspan(1));
  BoardMessage message;
  message.sequence = reader.get<std::uint8_t>();
  if (hello) {
    Hello said;
    said.protocol_version = reader.get<std::uint8_t>();
    for (auto& part : said.firmware) part = reader.get<std::uint8_t>();
    said.serial_number = reader.get<std::uint32_t>();
    said.joints = reader.get<std::uint8_t>();
    said.eyes = reader.get<std::uint8_t>();
    message.content = said;
    return message;
  }
  State state;
  state.time_ms = reader.get<std::uint32_t>();
  const auto frame = get_frame(reader);
  if (!frame) return std::nullopt;
  state.frame = *frame;
  state.status = reader.get<std::uint8_t>();
  message.content = state;
  return message;
}

std::optional<TorsoFrame> parse_command(std::span<const std::uint8_t> content) {
  if (!is(content, kSetFrame, kFrameLength)) return std::nullopt;
  FieldReader reader(content.subspan(2));
  return get_frame(reader);
}

bool is_hello_request(std::span<const std::uint8_t> content) { return is(content, kHello, 2); }

serial_frame::Frame hello_request(std::uint8_t sequence) {
  return FieldWriter(kHello, sequence).frame();
}

serial_frame::Frame heartbeat(std::uint8_t sequence) {
  return FieldWriter(kHeartbeat, sequence).frame();
}

serial_frame::Frame set_frame(std::uint8_t sequence, const TorsoFrame& frame) {
  FieldWriter writer(kSetFrame, sequence);
  put_frame(writer, frame);
  return writer.frame();
}

serial_frame::Frame to_frame(const BoardMessage& message) {
  if (const auto* hello = std::get_if<Hello>(&message.content)) {
    FieldWriter writer(kHello, message.sequence);
    writer.put(hello->protocol_version);
    for (const std::uint8_t part : hello->firmware) writer.put(part);
    return writer.put(hello->serial_number).put(hello->joints).put(hello->eyes).frame();
  }
  const auto& state = std::get<State>(message.content);
  FieldWriter writer(kState, message.sequence);
  writer.put(state.time_ms);
  put_frame(writer, state.frame);
  return writer.put(state.status).frame();
}

}  // namespace usher::torso
