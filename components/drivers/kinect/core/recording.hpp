#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/kinect/core/device.hpp"

namespace usher::kinect {

/// What the values of a recorded image are.
enum class Values { kMillimeters, kRaw11 };

/// A 16-bit grey PGM image (P5, 256..65535, most significant byte first as the format wants it;
/// recordings of libfreenect have the least significant one first). The error says what was found.
Result<Frame> parse_pgm(std::span<const std::uint8_t> bytes, bool little_endian);

/// An 8-bit color PPM image (P6, 255). The error says what was found.
Result<ColorFrame> parse_ppm(std::span<const std::uint8_t> bytes);

/// A folder with recorded depth images: what stands in its INDEX.txt with names
/// d-<time>-<stamp>.pgm (a recording of libfreenect's `record`), else all files *.pgm in the order
/// of their names, at 30 Hz.
class Recording {
 public:
  static Result<Recording> open(const std::string& folder, Values values);

  std::size_t size() const { return files_.size(); }
  /// [s] from the first image to this one.
  double time(std::size_t index) const { return times_[index]; }
  /// Reads an image; blocks. The error names the file.
  Result<Frame> read(std::size_t index) const;
  bool has_color(std::size_t index) const { return !colors_[index].empty(); }
  /// The color image of the same moment (at most 20 ms apart): r-<time>-<stamp>.ppm of INDEX.txt,
  /// else the file NAME.ppm beside NAME.pgm. Blocks. The error names the file, or says that none
  /// was recorded.
  Result<ColorFrame> read_color(std::size_t index) const;

 private:
  std::vector<std::string> files_;
  std::vector<double> times_;
  std::vector<std::string> colors_;  // of each depth image; empty: none
  Values values_ = Values::kMillimeters;
  bool little_endian_ = false;
};

}  // namespace usher::kinect
