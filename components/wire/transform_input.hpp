#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "foundation/geometry/transform_buffer.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "wire/conversions.hpp"

namespace usher::wire {

/// A component's view of the frames: reads tf and tf_static into a TransformBuffer, leaves out
/// those of people (each has a new name, and the buffer takes 64), and holds back work that needs a
/// transform which is not known yet.
class TransformInput {
 public:
  explicit TransformInput(runtime::Host& host);
  TransformInput(const TransformInput&) = delete;
  TransformInput& operator=(const TransformInput&) = delete;

  Result<geometry::Pose3> lookup(const std::string& target, const std::string& source,
                                 runtime::Time stamp) const {
    return buffer_.lookup(target, source, stamp.time_since_epoch());
  }
  Result<geometry::Pose2> lookup_planar(const std::string& target, const std::string& source,
                                        runtime::Time stamp) const;
  /// The newest one in the plane, unless that is older than `most`.
  std::optional<geometry::Pose2> newest_planar(const std::string& target, const std::string& source,
                                               runtime::Duration most) const;
  const geometry::TransformBuffer& buffer() const { return buffer_; }

  /// Runs `work(target_T_source)` now or in the handler that makes the transform known: in order of
  /// arrival for one source frame, while no source waits for another. Work that waited 100 ms is
  /// dropped and counted ("tf: dropped"); when more than 16 wait, so is the oldest of the same
  /// source, or of all where none of that source waits.
  void when_known(const std::string& target, const std::string& source, runtime::Time stamp,
                  std::function<void(const geometry::Pose3&)> work);

 private:
  struct Waiting {
    std::string target, source;
    runtime::Time stamp, since;
    std::function<void(const geometry::Pose3&)> work;
  };
  void take(const tf2_msgs::msg::TFMessage& message, bool fixed);
  void serve();

  runtime::Host& host_;
  geometry::TransformBuffer buffer_;
  std::deque<Waiting> waiting_;
  std::uint64_t& dropped_;
  std::uint64_t& refused_;
  runtime::Input<tf2_msgs::msg::TFMessage> moving_;
  runtime::Input<tf2_msgs::msg::TFMessage> fixed_;
};

}  // namespace usher::wire
