#include "drivers/kinect/core/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "drivers/kinect/core/camera_model.hpp"

namespace usher::kinect {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 16 << 20;
constexpr std::size_t kMostFrames = 100'000;
constexpr int kMostPixels = 4096;
constexpr double kPeriod = 1.0 / 30.0;  // [s]
constexpr double kOneMoment = 0.02;     // [s]

/// The next number of a PGM header; nothing when there is none below 100 000.
std::optional<int> next_number(std::span<const std::uint8_t> bytes, std::size_t& at) {
  const auto space = [](std::uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  while (at < bytes.size() && (space(bytes[at]) || bytes[at] == '#')) {
    if (bytes[at] == '#') {
      while (at < bytes.size() && bytes[at] != '\n') ++at;
    } else {
      ++at;
    }
  }
  int value = 0;
  const std::size_t first = at;
  for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; ++at) {
    value = 10 * value + (bytes[at] - '0');
    if (value >= 100'000) return std::nullopt;
  }
  return at > first ? std::optional(value) : std::nullopt;
}

Result<std::vector<std::uint8_t>> read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream) return Error{path + ": cannot be opened"};
  const auto size = static_cast<std::size_t>(stream.tellg());
  if (size > kLargestFile) return Error{path + ": larger than 16 MiB"};
  std::vector<std::uint8_t> bytes(size);
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream) return Error{path + ": cannot be read"};
  return bytes;
}

/// The time in d-<time>-<stamp>.pgm, of a depth image, or r-<time>-<stamp>.ppm, of a color image
/// [s].
std::optional<double> time_of(const std::string& name, bool color = false) {
  if (!name.starts_with(color ? "r-" : "d-") || !name.ends_with(color ? ".ppm" : ".pgm"))
    return std::nullopt;
  double time = 0.0;
  const auto [end, error] = std::from_chars(name.data() + 2, name.data() + name.size(), time);
  if (error != std::errc{} || *end != '-') return std::nullopt;
  return time;
}

/// Path of the color image that belongs to a depth image; empty when there is none. `time` is NaN
/// where the recording has no index.
std::string color_beside(const fs::path& folder, const std::string& depth, double time,
                         const std::vector<std::pair<double, std::string>>& colors) {
  if (std::isnan(time)) {
    const fs::path path = (folder / depth).replace_extension(".ppm");
    std::error_code error;
    return fs::exists(path, error) ? path.string() : std::string();
  }
  double apart = kOneMoment;
  std::string nearest;
  for (const auto& [when, name] : colors) {
    if (std::abs(when - time) > apart) continue;
    apart = std::abs(when - time);
    nearest = (folder / name).string();
  }
  return nearest;
}

}  // namespace

Result<Frame> parse_pgm(std::span<const std::uint8_t> bytes, bool little_endian) {
  if (bytes.size() < 2 || bytes[0] != 'P' || bytes[1] != '5')
    return Error{"expected a PGM image (P5)"};
  std::size_t at = 2;
  const auto width = next_number(bytes, at);
  const auto height = next_number(bytes, at);
  const auto most = next_number(bytes, at);
  if (!width || !height || !most) return Error{"the PGM header is not complete"};
  if (*width < 1 || *height < 1 || *width > kMostPixels || *height > kMostPixels)
    return Error{"a PGM image of " + std::to_string(*width) + " x " + std::to_string(*height)};
  if (*most < 256 || *most > 65535)
    return Error{"a depth image has 16 bits, this one values up to " + std::to_string(*most)};
  ++at;  // one white space after the header
  const auto count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  if (at > bytes.size() || bytes.size() - at < 2 * count)
    return Error{"the PGM image ends early: expected " + std::to_string(2 * count) + " bytes"};
  Frame frame{*width, *height, std::vector<std::uint16_t>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t first = bytes[at + 2 * i], second = bytes[at + 2 * i + 1];
    frame.millimeters[i] =
        static_cast<std::uint16_t>(little_endian ? second << 8 | first : first << 8 | second);
  }
  return frame;
}

Result<ColorFrame> parse_ppm(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2 || bytes[0] != 'P' || bytes[1] != '6')
    return Error{"expected a PPM image (P6)"};
  std::size_t at = 2;
  const auto width = next_number(bytes, at);
  const auto height = next_number(bytes, at);
  const auto most = next_number(bytes, at);
  if (!width || !height || !most) return Error{"the PPM header is not complete"};
  if (*width < 1 || *height < 1 || *width > kMostPixels || *height > kMostPixels)
    return Error{"a PPM image of " + std::to_string(*width) + " x " + std::to_string(*height)};
  if (*most != 255)
    return Error{"a color image has 8 bits, this one values up to " + std::to_string(*most)};
  ++at;  // one white space after the header
  const auto count = 3 * static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  if (at > bytes.size() || bytes.size() - at < count)
    return Error{"the PPM image ends early: expected " + std::to_string(count) + " bytes"};
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  return ColorFrame{*width, *height, {first, first + static_cast<std::ptrdiff_t>(count)}};
}

Result<Recording> Recording::open(const std::string& folder, Values values) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return Error{folder + ": no folder with a recording"};
  Recording recording;
  recording.values_ = values;
  std::vector<std::string> names;
  std::vector<std::pair<double, std::string>> colors;  // by time
  if (std::ifstream index(fs::path(folder) / "INDEX.txt"); index) {
    recording.little_endian_ = true;
    for (std::string line; std::getline(index, line) && names.size() < kMostFrames;) {
      if (time_of(line)) names.push_back(line);
      if (const auto time = time_of(line, true)) colors.emplace_back(*time, line);
    }
  } else {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".pgm" && names.size() < kMostFrames)
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
  }
  if (names.empty()) return Error{folder + ": holds no depth images (INDEX.txt or *.pgm)"};
  const auto first = time_of(names.front());
  for (std::size_t i = 0; i < names.size(); ++i) {
    double time = std::nan("");
    if (recording.little_endian_) time = time_of(names[i]).value_or(time);
    const double since =
        first && !std::isnan(time) ? time - *first : static_cast<double>(i) * kPeriod;
    if (!recording.times_.empty() && since < recording.times_.back())
      return Error{folder + "/INDEX.txt: the times go back at " + names[i]};
    recording.files_.push_back((fs::path(folder) / names[i]).string());
    recording.times_.push_back(since);
    recording.colors_.push_back(color_beside(folder, names[i], time, colors));
  }
  return recording;
}

Result<Frame> Recording::read(std::size_t index) const {
  const auto bytes = read_file(files_[index]);
  if (!bytes) return Error{bytes.error()};
  auto frame = parse_pgm(*bytes, little_endian_);
  if (!frame) return Error{files_[index] + ": " + frame.error()};
  if (values_ == Values::kRaw11) {
    for (std::uint16_t& value : frame->millimeters) value = millimeters_of_raw(value);
  }
  return frame;
}

Result<ColorFrame> Recording::read_color(std::size_t index) const {
  if (colors_[index].empty()) return Error{files_[index] + ": no color image of that moment"};
  const auto bytes = read_file(colors_[index]);
  if (!bytes) return Error{bytes.error()};
  auto frame = parse_ppm(*bytes);
  if (!frame) return Error{colors_[index] + ": " + frame.error()};
  return frame;
}

}  // namespace usher::kinect
