#pragma once

#include "drivers/base_obedience/shell/base_line.hpp"
#include "drivers/segway_rmp/core/link.hpp"
#include "drivers/segway_rmp/shell/base_driver.hpp"

namespace usher::segway_rmp {

/// The driver over the base's serial line.
class SegwayRmpComponent final : public runtime::Component {
 public:
  explicit SegwayRmpComponent(runtime::Host& host);

 private:
  static Link::Parameters read_parameters(runtime::Parameters& parameters);
  void emergency(bool on);
  void keep();

  runtime::Host& host_;
  drive::BaseLine<Link, SegwayFeedback> line_;
  BaseDriver driver_;
  runtime::Timer keep_again_;
  bool kept_ = false;     ///< the memory says that its motors were switched off
  bool keeping_ = false;  ///< it is on its way to the disk
};

}  // namespace usher::segway_rmp
