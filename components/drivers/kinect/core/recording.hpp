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

 private:
  std::vector<std::string> files_;
  std::vector<double> times_;
  Values values_ = Values::kMillimeters;
  bool little_endian_ = false;
};

}  // namespace usher::kinect
