#pragma once

#include "drivers/laser_scanner/shell/scanner_line.hpp"
#include "drivers/urg04lx/core/session.hpp"

namespace usher::urg04lx {

/// The driver over the scanner's USB or serial line.
class Urg04lxComponent final : public runtime::Component {
 public:
  explicit Urg04lxComponent(runtime::Host& host);

 private:
  std::uint64_t& rejected_;
  laser_scanner::ScannerLine<Session> line_;
};

}  // namespace usher::urg04lx
