// The picture half of map files: PGM by our own reader (16 bit, comments, exact errors), PNG by
// OpenCV.
#include <algorithm>
#include <cassert>
#include <cctype>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "foundation/grid/map_file.hpp"

namespace usher::grid {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Size check that cannot overflow.
bool fits(std::uint64_t width, std::uint64_t height, std::size_t max_cells) {
  return width > 0 && height > 0 && width <= max_cells && height <= max_cells / width &&
         width <= 0x7fffffff && height <= 0x7fffffff;
}

std::string size_error(std::uint64_t width, std::uint64_t height, std::size_t max_cells) {
  return "expected a picture of 1 to " + std::to_string(max_cells) + " pixels, found " +
         std::to_string(width) + " x " + std::to_string(height);
}

/// Reads the numbers of a PNM header or of P2 data: white space and comments (# to the end of the
/// line) between.
class PgmReader {
 public:
  PgmReader(Bytes bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Result<MapImage> read(std::size_t max_cells) {
    const bool binary = bytes_[1] == '5';
    position_ = 2;
    const auto width = number("a width");
    const auto height = width ? number("a height") : std::nullopt;
    const auto max_value = height ? number("a largest value") : std::nullopt;
    if (!max_value) return failure_;
    if (!fits(*width, *height, max_cells)) return fail(size_error(*width, *height, max_cells));
    if (*max_value < 1 || *max_value > 65535) {
      return fail("expected a largest value of 1 to 65535, found " + std::to_string(*max_value));
    }
    MapImage image;
    image.width = static_cast<int>(*width);
    image.height = static_cast<int>(*height);
    image.max_value = static_cast<int>(*max_value);
    const std::size_t count = *width * *height;
    const Status status = binary ? read_binary(image, count) : read_text(image, count);
    if (!status) return Error{status.error()};
    return image;
  }

 private:
  Error fail(const std::string& what) const {
    return {name_ + ":" + std::to_string(line_) + ": " + what};
  }

  void skip_comment() {
    while (position_ < bytes_.size() && bytes_[position_] != '\n') ++position_;
  }

  std::optional<std::uint32_t> number(const char* expected) {
    for (; position_ < bytes_.size(); ++position_) {
      if (bytes_[position_] == '#') skip_comment();
      if (position_ >= bytes_.size() || std::isspace(bytes_[position_]) == 0) break;
      if (bytes_[position_] == '\n') ++line_;
    }
    std::uint64_t value = 0;
    const std::size_t first = position_;
    for (; position_ < bytes_.size() && std::isdigit(bytes_[position_]) != 0 && value <= 0xffffffff;
         ++position_) {
      value = value * 10 + (bytes_[position_] - '0');
    }
    if (position_ == first || value > 0xffffffff) {
      const std::string found = position_ >= bytes_.size()
                                    ? "the end of the file"
                                    : "byte " + std::to_string(bytes_[position_]);
      failure_ = fail(std::string("expected ") + expected + ", found " + found);
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(value);
  }

  /// Where the samples begin: one white space after the largest value. A comment or CRLF in that
  /// place is not standard but occurs; it is taken for one only when exactly the samples remain
  /// behind it.
  std::size_t samples_begin(std::size_t needed) {
    if (position_ < bytes_.size() && bytes_[position_] == '#') skip_comment();
    const std::size_t plain = std::min(position_ + 1, bytes_.size());
    std::size_t other = plain;
    if (other < bytes_.size() && bytes_[other] == '\n' && bytes_[plain - 1] == '\r') ++other;
    while (other < bytes_.size() && bytes_[other] == '#') {
      while (other < bytes_.size() && bytes_[other] != '\n') ++other;
      if (other < bytes_.size()) ++other;
    }
    return bytes_.size() - other == needed ? other : plain;
  }

  Status read_binary(MapImage& image, std::size_t count) {
    const std::size_t width = image.max_value > 255 ? 2 : 1;
    const std::size_t begin = samples_begin(count * width);
    if (bytes_.size() - begin < count * width) {
      return fail("expected " + std::to_string(count * width) + " bytes of samples, found " +
                  std::to_string(bytes_.size() - begin));
    }
    image.samples.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* sample = bytes_.data() + begin + i * width;
      image.samples[i] =
          width == 1 ? sample[0] : static_cast<std::uint16_t>(sample[0] << 8 | sample[1]);
      if (image.samples[i] > image.max_value) return too_large(image, i);
    }
    return {};
  }

  Status read_text(MapImage& image, std::size_t count) {
    // A sample takes two bytes, but for the last: refuses a header that promises more than there
    // is.
    if (count > (bytes_.size() - position_ + 1) / 2) {
      return fail("expected " + std::to_string(count) + " samples, found " +
                  std::to_string(bytes_.size() - position_) + " bytes of text");
    }
    image.samples.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto sample = number("a sample");
      if (!sample) return failure_;
      image.samples[i] = static_cast<std::uint16_t>(std::min<std::uint32_t>(*sample, 65535));
      if (*sample > static_cast<std::uint32_t>(image.max_value)) return too_large(image, i);
    }
    return {};
  }

  Error too_large(const MapImage& image, std::size_t i) const {
    const auto width = static_cast<std::size_t>(image.width);
    return fail("expected samples up to " + std::to_string(image.max_value) + ", found " +
                std::to_string(image.samples[i]) + " in row " + std::to_string(i / width) +
                ", column " + std::to_string(i % width));
  }

  Bytes bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  Error failure_;
};

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

std::uint32_t big_endian(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) << 24 |
         static_cast<std::uint32_t>(bytes[at + 1]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 8 | bytes[at + 3];
}

Result<MapImage> decode_png(Bytes bytes, const std::string& name, std::size_t max_cells) {
  if (bytes.size() < 33)
    return Error{name + ": expected a PNG header, found " + std::to_string(bytes.size()) +
                 " bytes"};
  const std::uint32_t width = big_endian(bytes, 16);
  const std::uint32_t height = big_endian(bytes, 20);
  if (!fits(width, height, max_cells))
    return Error{name + ": " + size_error(width, height, max_cells)};
  cv::Mat picture;
  try {
    // The decoder only reads, but cv::Mat has no constant view.
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U,
                          const_cast<std::uint8_t*>(bytes.data()));
    picture = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& exception) {
    return Error{name + ": " + exception.what()};
  }
  if (picture.empty()) return Error{name + ": expected a PNG picture, found damaged data"};
  MapImage image;
  image.width = picture.cols;
  image.height = picture.rows;
  image.channels = picture.channels();
  image.max_value = picture.depth() == CV_16U ? 65535 : 255;
  cv::Mat wide;
  picture.convertTo(wide, CV_16U);
  image.samples.assign(wide.ptr<std::uint16_t>(),
                       wide.ptr<std::uint16_t>() + wide.total() * wide.elemSize() / 2);
  return image;
}

}  // namespace

Result<MapImage> decode_map_image(std::span<const std::uint8_t> bytes, const std::string& name,
                                  std::size_t max_cells) {
  if (bytes.size() >= 8 && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) {
    return decode_png(bytes, name, max_cells);
  }
  if (bytes.size() >= 3 && bytes[0] == 'P' && (bytes[1] == '2' || bytes[1] == '5')) {
    return PgmReader(bytes, name).read(max_cells);
  }
  return Error{name + ":1: expected a PGM (P2 or P5) or PNG picture, found neither signature"};
}

OccupancyGrid to_occupancy(const MapImage& image, const MapDescription& description) {
  const auto width = static_cast<std::size_t>(image.width);
  const auto channels = static_cast<std::size_t>(image.channels);
  assert(image.samples.size() == width * static_cast<std::size_t>(image.height) * channels);
  OccupancyGrid map({image.width, image.height, description.resolution, description.origin.x,
                     description.origin.y});
  const bool has_alpha = image.channels == 4;
  const std::size_t averaged = has_alpha && description.mode != MapMode::kTrinary ? 3 : channels;
  const double whole = static_cast<double>(averaged) * image.max_value;
  const double low = description.free_threshold;
  const double high = description.occupied_threshold;

  const auto value_of = [&](const std::uint16_t* pixel) -> std::int8_t {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < averaged; ++i) sum += pixel[i];
    if (description.mode == MapMode::kRaw) {
      const double value = std::round(255.0 * sum / whole);
      return value <= 100.0 ? static_cast<std::int8_t>(value) : kUnknown;
    }
    if (description.mode == MapMode::kScale && has_alpha && pixel[3] != image.max_value)
      return kUnknown;
    // One division of exact integers: thresholds that are fractions of the largest value compare
    // exactly.
    const double occupied = (description.negate ? sum : whole - sum) / whole;
    if (occupied > high) return kOccupied;
    if (occupied < low) return kFree;
    if (description.mode == MapMode::kTrinary || high <= low) return kUnknown;
    return static_cast<std::int8_t>(std::rint(100.0 * (occupied - low) / (high - low)));
  };
  for (int y = 0; y < image.height; ++y) {
    const std::uint16_t* pixel =
        image.samples.data() + static_cast<std::size_t>(image.height - 1 - y) * width * channels;
    std::int8_t* cell = map.row(y);
    for (std::size_t x = 0; x < width; ++x) cell[x] = value_of(pixel + x * channels);
  }
  return map;
}

}  // namespace usher::grid
