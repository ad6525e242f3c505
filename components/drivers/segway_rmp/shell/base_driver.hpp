#pragma once

#include <string>

#include "drivers/base_obedience/shell/obedient_base.hpp"
#include "drivers/segway_rmp/core/device.hpp"
#include "drivers/segway_rmp/core/odometry.hpp"

namespace usher::segway_rmp {

/// What the real and the simulated base have in common: obedience, and the way over the floor from
/// wheels that turn with a leaning body.
class BaseDriver {
 public:
  BaseDriver(runtime::Host& host, drive::BaseDevice device);

  /// One control cycle of the base came in.
  void take(const SegwayFeedback& feedback);
  /// What the base says of itself: why it does not drive, or a warning; empty when all is well.
  void warn(const std::string& reason) { warning_ = reason; }
  /// The base is not heard; why.
  void disconnected(const std::string& reason);

 private:
  runtime::Host& host_;
  drive::ObedientBase base_;
  Odometry odometry_;
  std::string warning_;
  std::uint64_t& rejected_feedback_;
};

}  // namespace usher::segway_rmp
