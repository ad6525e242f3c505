#include "drivers/p3dx/core/information.hpp"

#include <algorithm>

#include "foundation/geometry/angle.hpp"

namespace usher::p3dx {

namespace {

constexpr std::uint8_t kStopped = 0x32;
constexpr std::uint8_t kMoving = 0x33;

/// Takes little-endian fields from the front; past the end everything is zero and ok() false.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint8_t u8() {
    if (bytes_.empty()) {
      ok_ = false;
      return 0;
    }
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | static_cast<unsigned>(u8()) << 8);
  }
  std::int16_t i16() { return static_cast<std::int16_t>(u16()); }
  std::size_t left() const { return bytes_.size(); }
  bool ok() const { return ok_; }

 private:
  std::span<const std::uint8_t> bytes_;
  bool ok_ = true;
};

}  // namespace

std::optional<Information> parse_information(std::span<const std::uint8_t> packet) {
  Reader reader(packet);
  const std::uint8_t type = reader.u8();
  if (type != kStopped && type != kMoving) return std::nullopt;
  Information info;
  info.moving = type == kMoving;
  info.x = reader.u16();
  info.y = reader.u16();
  info.heading = reader.i16();
  info.left_velocity = reader.i16();
  info.right_velocity = reader.i16();
  info.battery = 0.1 * reader.u8();
  const std::uint16_t stall = reader.u16();
  info.left_stall = (stall & 0x0001) != 0;
  info.right_stall = (stall & 0x0100) != 0;
  reader.u16();  // the set-point of the heading
  const std::uint16_t flags = reader.u16();
  info.motors_on = (flags & 0x0001) != 0;
  info.stop_button = (flags & 0x0020) != 0;
  info.stall_stop = (flags & 0x0040) != 0;
  reader.u8();  // compass
  const std::size_t count = reader.u8();
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const SonarReading reading{reader.u8(), reader.u16()};
    if (info.sonar_count < info.sonar.size()) info.sonar[info.sonar_count++] = reading;
  }
  reader.u8();   // gripper
  reader.u16();  // analog input
  reader.u16();  // digital input and output
  if (!reader.ok()) return std::nullopt;
  if (reader.left() >= 2) info.battery = 0.1 * reader.u16();
  if (reader.left() >= 3) {
    reader.u8();  // charger
    info.rotation_rate = geometry::radians(0.1 * reader.i16());
  }
  return info;
}

}  // namespace usher::p3dx
