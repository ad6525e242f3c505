#pragma once

#include "drivers/base_obedience/shell/base_line.hpp"
#include "drivers/segway_rmp/core/link.hpp"
#include "drivers/segway_rmp/shell/base_driver.hpp"
#include "wire/keeper.hpp"

namespace usher::segway_rmp {

/// The driver over the base's serial line.
class SegwayRmpComponent final : public runtime::Component {
 public:
  explicit SegwayRmpComponent(runtime::Host& host);

 private:
  static Link::Parameters read_parameters(runtime::Parameters& parameters);
  void emergency(bool on);
  void remember();
  void count();

  std::uint64_t& damaged_packets_;
  std::uint64_t& skipped_bytes_;
  std::uint64_t& incomplete_cycles_;
  std::uint64_t& counter_jumps_;
  drive::BaseLine<Link, SegwayFeedback> line_;
  BaseDriver driver_;
  wire::Keeper memory_;    ///< that its motors were switched off
  wire::Keeper balanced_;  ///< that it balanced
};

}  // namespace usher::segway_rmp
