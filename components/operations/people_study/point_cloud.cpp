#include "operations/people_study/point_cloud.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

namespace usher::people_study {

namespace {

constexpr std::size_t kMostBytes = 64U << 20;
constexpr int kMostPixels = 4096;

/// LZF as PCD files use it: literal runs and references to what came before. False when the bytes
/// do not give exactly `out`.
bool expand(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  std::size_t from = 0, to = 0;
  while (from < in.size()) {
    const std::size_t control = in[from++];
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > in.size() - from || length > out.size() - to) return false;
      std::memcpy(out.data() + to, in.data() + from, length);
      from += length, to += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (from == in.size()) return false;
      length += in[from++];
    }
    if (from == in.size()) return false;
    const std::size_t back = ((control & 31U) << 8) + in[from++] + 1;
    length += 2;
    if (back > to || length > out.size() - to) return false;
    for (; length > 0; --length, ++to) out[to] = out[to - back];
  }
  return to == out.size();
}

std::uint32_t number(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

}  // namespace

Result<PointCloudDepth> parse_point_cloud(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::string_view kData = "\nDATA binary_compressed\n";
  const std::size_t data = text.substr(0, 4096).find(kData);
  if (data == std::string_view::npos) return Error{"expected a PCD file, DATA binary_compressed"};
  std::istringstream header{std::string(text.substr(0, data))};
  PointCloudDepth cloud;
  std::string word, line;
  bool xyz = false;
  while (std::getline(header, line)) {
    std::istringstream words(line);
    words >> word;
    if (word == "WIDTH") words >> cloud.width;
    if (word == "HEIGHT") words >> cloud.height;
    if (word == "FIELDS") xyz = line.starts_with("FIELDS x y z");
  }
  const bool sized = cloud.width >= 1 && cloud.width <= kMostPixels && cloud.height >= 1 &&
                     cloud.height <= kMostPixels;
  if (!xyz || !sized) return Error{"expected fields x y z and at most 4096 x 4096 points"};
  const auto body = bytes.subspan(data + kData.size());
  if (body.size() < 8) return Error{"expected the sizes of the data, got the end of the file"};
  const std::size_t packed = number(body), whole = number(body.subspan(4));
  const std::size_t points =
      static_cast<std::size_t>(cloud.width) * static_cast<std::size_t>(cloud.height);
  if (packed > body.size() - 8 || whole > kMostBytes || whole < 12 * points)
    return Error{"expected " + std::to_string(points) + " points, got fewer bytes"};
  std::vector<std::uint8_t> values(whole);
  if (!expand(body.subspan(8, packed), values)) return Error{"the compressed data is damaged"};
  cloud.millimeters.resize(points);
  for (std::size_t i = 0; i < points; ++i) {
    float z = 0.0F;
    std::memcpy(&z, values.data() + 8 * points + 4 * i, sizeof z);
    const bool valid = std::isfinite(z) && z > 0.0F && z < 60.0F;
    cloud.millimeters[i] = valid ? static_cast<std::uint16_t>(std::lround(1e3F * z)) : 0;
  }
  return cloud;
}

Result<PointCloudDepth> read_point_cloud(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{"cannot read " + path};
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  auto cloud = parse_point_cloud(bytes);
  return cloud ? std::move(cloud) : Error{path + ": " + cloud.error()};
}

}  // namespace usher::people_study
