#pragma once

#include "drivers/laser_scanner/shell/scanner_line.hpp"
#include "drivers/lms100/core/session.hpp"

namespace usher::lms100 {

/// The driver over the scanner's TCP line.
class Lms100Component final : public runtime::Component {
 public:
  explicit Lms100Component(runtime::Host& host);

 private:
  static Session::Parameters read_parameters(runtime::Parameters& parameters);

  std::uint64_t& lost_;
  std::uint64_t& rejected_;
  std::uint64_t& skipped_bytes_;
  std::uint64_t& damaged_;
  laser_scanner::ScannerLine<Session> line_;
};

}  // namespace usher::lms100
