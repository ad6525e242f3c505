#include "foundation/grid/map_file.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

namespace usher::grid {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxYamlBytes = 65536;
constexpr double kMaxCoordinate = 1e6;  // [m] keeps cell numbers far inside an int
constexpr int kFreeUpTo = 25;           // [%] the saver's decisions, those of map_saver
constexpr int kOccupiedFrom = 65;       // [%]
constexpr std::uint8_t kFreePixel = 254;
constexpr std::uint8_t kUnknownPixel = 205;
constexpr std::uint8_t kOccupiedPixel = 0;

/// Reads the known keys of one YAML map and keeps the first error with its line.
class DescriptionReader {
 public:
  explicit DescriptionReader(const std::string& name) : name_(name) {}

  Result<MapDescription> read(const YAML::Node& root) {
    if (!root.IsMap())
      return fail(root, "expected keys and values (image, resolution, origin, ...)");
    const std::map<std::string, std::function<Status(const YAML::Node&)>> readers = {
        {"image", [this](const YAML::Node& node) { return read_image(node); }},
        {"mode", [this](const YAML::Node& node) { return read_mode(node); }},
        {"resolution",
         [this](const YAML::Node& node) { return read_number(node, 1e-4, 1.0, map_.resolution); }},
        {"origin", [this](const YAML::Node& node) { return read_origin(node); }},
        {"negate", [this](const YAML::Node& node) { return read_negate(node); }},
        {"occupied_thresh",
         [this](const YAML::Node& node) {
           return read_number(node, 0.0, 1.0, map_.occupied_threshold);
         }},
        {"free_thresh",
         [this](const YAML::Node& node) {
           return read_number(node, 0.0, 1.0, map_.free_threshold);
         }},
    };
    std::map<std::string, int> seen;
    for (const auto& entry : root) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a word)";
      const auto reader = readers.find(key);
      if (reader == readers.end()) return fail(entry.first, "unknown key " + key);
      if (++seen[key] > 1) return fail(entry.first, "key " + key + " occurs twice");
      key_ = key;
      const Status status = reader->second(entry.second);
      if (!status) return Error{status.error()};
    }
    for (const auto& [key, reader] : readers) {
      if (key != "mode" && seen.find(key) == seen.end())
        return fail(root, "expected the key " + key + ", found none");
    }
    if (map_.free_threshold > map_.occupied_threshold) {
      return fail(root["free_thresh"], "free_thresh must be at most occupied_thresh (" +
                                           std::to_string(map_.occupied_threshold) + "), got " +
                                           std::to_string(map_.free_threshold));
    }
    return map_;
  }

 private:
  Error fail(const YAML::Node& node, const std::string& what) const {
    return {name_ + ":" + std::to_string(std::max(0, node.Mark().line) + 1) + ": " + what};
  }
  Error expected(const YAML::Node& node, const std::string& what) const {
    const std::string found = node.IsScalar() ? "'" + node.Scalar() + "'" : "something else";
    return fail(node, key_ + " must be " + what + ", got " + found);
  }

  Status read_image(const YAML::Node& node) {
    if (!node.IsScalar() || node.Scalar().empty()) return expected(node, "the path of a picture");
    map_.image = node.Scalar();
    return {};
  }

  Status read_mode(const YAML::Node& node) {
    const std::string word = node.IsScalar() ? node.Scalar() : "";
    if (word == "trinary")
      map_.mode = MapMode::kTrinary;
    else if (word == "scale")
      map_.mode = MapMode::kScale;
    else if (word == "raw")
      map_.mode = MapMode::kRaw;
    else
      return expected(node, "trinary, scale or raw");
    return {};
  }

  Status read_negate(const YAML::Node& node) {
    int number = 0;
    if (!node.IsScalar() || !(YAML::convert<int>::decode(node, number) ||
                              YAML::convert<bool>::decode(node, map_.negate))) {
      return expected(node, "0, 1, true or false");
    }
    map_.negate = map_.negate || number != 0;
    return {};
  }

  Status read_number(const YAML::Node& node, double low, double high, double& value) {
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) ||
        !(value >= low && value <= high)) {
      std::array<char, 64> range{};
      std::snprintf(range.data(), range.size(), "a number in [%g, %g]", low, high);
      return expected(node, range.data());
    }
    return {};
  }

  Status read_origin(const YAML::Node& node) {
    if (!node.IsSequence() || node.size() != 3) return expected(node, "three numbers [x, y, yaw]");
    const std::array<double*, 3> values = {&map_.origin.x, &map_.origin.y, &map_.origin.yaw};
    for (std::size_t i = 0; i < 3; ++i) {
      auto status = read_number(node[i], -kMaxCoordinate, kMaxCoordinate, *values[i]);
      if (!status) return status;
    }
    return {};
  }

  const std::string& name_;
  std::string key_;
  MapDescription map_;
};

Result<std::vector<std::uint8_t>> read_file(const std::string& path, std::uint64_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return Error{path + ": expected a file, found none"};
  const std::uint64_t size = fs::file_size(path, error);
  if (error) return Error{path + ": " + error.message()};
  if (size > max_bytes) {
    return Error{path + ": expected at most " + std::to_string(max_bytes) + " bytes, found " +
                 std::to_string(size)};
  }
  std::vector<std::uint8_t> bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) return Error{path + ": cannot be read"};
  return bytes;
}

/// Writes beside the target and renames, so that a reader never sees half a file.
Status write_file(const std::string& path, const std::string& content) {
  const std::string partial = path + ".part";
  {
    std::ofstream file(partial, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (!file) return Error{path + ": cannot be written"};
  }
  std::error_code error;
  fs::rename(partial, path, error);
  if (error) return Error{path + ": " + error.message()};
  return {};
}

}  // namespace

Result<MapDescription> parse_map_description(const std::string& text, const std::string& name) {
  try {
    return DescriptionReader(name).read(YAML::Load(text));
  } catch (const YAML::Exception& exception) {
    return Error{name + ":" + std::to_string(std::max(0, exception.mark.line) + 1) + ": " +
                 exception.msg};
  }
}

Result<OccupancyGrid> load_map(const std::string& yaml_path, std::size_t max_cells) {
  const auto text = read_file(yaml_path, kMaxYamlBytes);
  if (!text) return Error{text.error()};
  const auto description =
      parse_map_description(std::string(text->begin(), text->end()), yaml_path);
  if (!description) return Error{description.error()};
  const std::string image_path = (fs::path(yaml_path).parent_path() / description->image).string();
  // The longest picture of so many cells: 16-bit RGBA, or text with numbers of five digits.
  const auto bytes = read_file(image_path, std::uint64_t{max_cells} * 8 + 65536);
  if (!bytes) return Error{bytes.error()};
  const auto image = decode_map_image(*bytes, image_path, max_cells);
  if (!image) return Error{image.error()};
  OccupancyGrid map = to_occupancy(*image, *description);
  if (geometry::normalized(description->origin.yaw) == 0.0) return map;
  auto upright = turned_upright(map, description->origin, max_cells);
  if (!upright) return Error{yaml_path + ": " + upright.error()};
  return upright;
}

Status save_map(const OccupancyGrid& map, const std::string& yaml_path) {
  if (map.empty()) return Error{yaml_path + ": expected a map with cells, found an empty one"};
  const fs::path image_path = fs::path(yaml_path).replace_extension(".pgm");
  if (image_path == fs::path(yaml_path))
    return Error{yaml_path + ": expected a name that does not end in .pgm"};
  std::string image =
      "P5\n" + std::to_string(map.width()) + " " + std::to_string(map.height()) + "\n255\n";
  image.reserve(image.size() + map.size());
  for (int y = map.height() - 1; y >= 0; --y) {
    for (int x = 0; x < map.width(); ++x) {
      const std::int8_t value = map.row(y)[x];
      const std::uint8_t pixel = value < 0                ? kUnknownPixel
                                 : value <= kFreeUpTo     ? kFreePixel
                                 : value >= kOccupiedFrom ? kOccupiedPixel
                                                          : kUnknownPixel;
      image += static_cast<char>(pixel);
    }
  }
  YAML::Emitter image_name;  // quotes a name that YAML would misread
  image_name << image_path.filename().string();
  std::array<char, 256> rest{};
  std::snprintf(rest.data(), rest.size(),
                "mode: trinary\nresolution: %.6f\norigin: [%.6f, %.6f, 0.000000]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                map.resolution(), map.geometry().origin_x, map.geometry().origin_y);
  if (auto status = write_file(image_path.string(), image); !status) return status;
  return write_file(yaml_path, std::string("image: ") + image_name.c_str() + "\n" + rest.data());
}

}  // namespace usher::grid
