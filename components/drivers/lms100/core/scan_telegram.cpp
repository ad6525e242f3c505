#include "drivers/lms100/core/scan_telegram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "drivers/lms100/core/cola.hpp"

namespace usher::lms100 {

namespace {

constexpr double kRadiansPerUnit = 3.14159265358979323846 / 180.0 / 10000.0;
constexpr std::int32_t kStraightAhead = 900000;  // [1e-4 deg]
constexpr std::uint16_t kFirstDistance = 16;     // below are codes
constexpr std::uint32_t kMostEncoders = 8;

Error broken(const char* what) {
  return Error{std::string("LMDscandata: expected ") + what + ", the telegram is cut or malformed"};
}

/// The channels whose values have `width` bytes.
Status read_channels(FieldReader& fields, std::size_t width, ScanTelegram& telegram) {
  const std::uint32_t count = fields.number(2);
  if (!fields.ok()) return broken("a number of channels");
  if (count > telegram.channels.size() - telegram.channel_count) {
    return Error{"LMDscandata: expected at most 8 channels, got " +
                 std::to_string(telegram.channel_count + count)};
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    Channel& channel = telegram.channels[telegram.channel_count];
    const std::string_view content = fields.fixed_text(channel.content.size());
    channel.scale = fields.real();
    channel.offset = fields.real();
    channel.start_angle = fields.signed_number();
    channel.angular_step = static_cast<std::uint16_t>(fields.number(2));
    const std::uint32_t values = fields.number(2);
    if (!fields.ok() || values > fields.most(width)) return broken("a channel");
    std::copy(content.begin(), content.end(), channel.content.begin());
    channel.values.resize(values);
    for (std::uint16_t& value : channel.values) {
      value = static_cast<std::uint16_t>(fields.number(width));
    }
    if (!fields.ok()) return broken("a channel's values");
    ++telegram.channel_count;
  }
  return {};
}

}  // namespace

const Channel* ScanTelegram::find(std::string_view content) const {
  for (std::size_t i = 0; i < channel_count; ++i) {
    if (channels[i].is(content)) return &channels[i];
  }
  return nullptr;
}

Status read(const Message& message, ScanTelegram& telegram) {
  if (message.name != "LMDscandata" || (message.kind != "sSN" && message.kind != "sRA")) {
    return Error{"expected sSN or sRA LMDscandata, got " + std::string(message.kind) + " " +
                 std::string(message.name)};
  }
  FieldReader fields = message.fields;
  const auto number16 = [&fields] { return static_cast<std::uint16_t>(fields.number(2)); };
  telegram.channel_count = 0;
  telegram.version = number16();
  telegram.device_number = number16();
  telegram.serial_number = fields.number(4);
  for (std::uint8_t& status : telegram.status) status = static_cast<std::uint8_t>(fields.number(1));
  telegram.telegram_counter = number16();
  telegram.scan_counter = number16();
  telegram.scan_time = fields.number(4);
  telegram.transmission_time = fields.number(4);
  for (int i = 0; i < 4; ++i) fields.number(1);  // digital inputs and outputs
  fields.number(2);                              // reserved
  telegram.scan_frequency = fields.number(4);
  telegram.measurement_frequency = fields.number(4);
  const std::uint32_t encoders = fields.number(2);
  if (!fields.ok() || encoders > kMostEncoders) return broken("a header");
  for (std::uint32_t i = 0; i < encoders; ++i) {
    fields.number(4);  // position
    fields.number(2);  // speed
  }
  if (Status status = read_channels(fields, 2, telegram); !status) return status;
  return read_channels(fields, 1, telegram);
  // Position, name, comment, time and event follow; the robot has no use for them.
}

Status to_scan(const ScanTelegram& telegram, Time stamp, Scan& scan) {
  const Channel* distances = telegram.find("DIST1");
  if (!distances) return Error{"LMDscandata: expected a channel DIST1, found none"};
  if (distances->values.empty() || distances->angular_step == 0 ||
      !std::isfinite(distances->scale) || distances->scale <= 0.0F ||
      !std::isfinite(distances->offset)) {
    return Error{"LMDscandata: DIST1 has no values, no angular step or no positive scale"};
  }
  if (telegram.scan_frequency == 0) return Error{"LMDscandata: the scan frequency is zero"};

  scan.stamp = stamp;
  const std::int64_t start = std::int64_t{distances->start_angle} - kStraightAhead;
  scan.angle_min = static_cast<double>(start) * kRadiansPerUnit;
  scan.angle_increment = distances->angular_step * kRadiansPerUnit;
  scan.scan_time = 100.0 / telegram.scan_frequency;
  scan.time_increment = scan.scan_time * distances->angular_step / 3600000.0;

  const float scale = distances->scale * 0.001F;
  const float offset = distances->offset * 0.001F;
  scan.ranges.resize(distances->values.size());
  std::transform(distances->values.begin(), distances->values.end(), scan.ranges.begin(),
                 [scale, offset](std::uint16_t value) {
                   if (value >= kFirstDistance) return static_cast<float>(value) * scale + offset;
                   return value == 0 ? std::numeric_limits<float>::infinity()
                                     : std::numeric_limits<float>::quiet_NaN();
                 });
  scan.intensities.clear();
  const Channel* remission = telegram.find("RSSI1");
  if (remission && remission->values.size() == distances->values.size()) {
    scan.intensities.assign(remission->values.begin(), remission->values.end());
  }
  return {};
}

Time measured_at(const ScanTelegram& telegram, Time arrival, estimation::DeviceClock& clock) {
  const std::int64_t age = clock.step(telegram.scan_time, telegram.transmission_time);
  return clock.stamp(telegram.transmission_time, arrival) -
         clock.time_of(std::max(age, std::int64_t{0}));
}

}  // namespace usher::lms100
