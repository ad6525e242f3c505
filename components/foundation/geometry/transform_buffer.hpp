#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <string_view>

#include "foundation/geometry/pose3.hpp"
#include "foundation/result/result.hpp"

namespace usher::geometry {

/// The tree of frames over the last seconds. Each frame has one parent. Not thread-safe; bounded:
/// at most 64 frames, and 2048 samples a frame.
class TransformBuffer {
 public:
  using Stamp = std::chrono::nanoseconds;  ///< since the epoch of the host

  /// Samples older than `memory` before a frame's newest are forgotten; a lookup may lie at most
  /// `reach` after the newest sample, and is then extrapolated from the last two, or the newest
  /// when they are less than 1 ms apart.
  explicit TransformBuffer(Stamp memory = std::chrono::seconds(10),
                           Stamp reach = std::chrono::milliseconds(20))
      : memory_(memory), reach_(reach) {}

  /// Adds parent_T_child at a time. Refused: a frame under another parent, one that never moves,
  /// non-finite numbers, a rotation that is not of unit length (1e-3), a frame as its own parent, a
  /// time before the newest (same time: replaced), too many frames.
  Status add(std::string_view parent, std::string_view child, Stamp stamp,
             const Pose3& parent_T_child);
  /// The same for a frame that never moves; it is known at all times. May be repeated; refused: a
  /// frame that moves, and another place than the first.
  Status add_static(std::string_view parent, std::string_view child, const Pose3& parent_T_child);

  /// target_T_source at a time. Fails with the reason: unknown frame, not connected, before the
  /// memory, beyond the reach.
  Result<Pose3> lookup(std::string_view target, std::string_view source, Stamp stamp) const;
  /// The newest time at which every moving frame between the two has a sample; zero when all are
  /// static.
  Result<Stamp> newest(std::string_view target, std::string_view source) const;

 private:
  struct Sample {
    Stamp stamp;
    Pose3 pose;
  };
  struct Frame {
    std::string parent;
    bool fixed = false;
    std::deque<Sample> samples;
  };

  Status check(std::string_view parent, std::string_view child, bool fixed,
               const Pose3& pose) const;
  Result<Pose3> at(const std::string& child, const Frame& frame, Stamp stamp) const;

  Stamp memory_;
  Stamp reach_;
  std::map<std::string, Frame, std::less<>> frames_;
};

}  // namespace usher::geometry
