#pragma once

#include "drivers/lms100/core/session.hpp"
#include "drivers/lms100/shell/scan_publisher.hpp"

namespace usher::lms100 {

/// The driver over the scanner's TCP line.
class Lms100Component final : public runtime::Component {
 public:
  explicit Lms100Component(runtime::Host& host);

 private:
  static Session::Parameters read_parameters(runtime::Parameters& parameters);
  Time now() const { return host_.now().time_since_epoch(); }
  void flush();
  void report();

  runtime::Host& host_;
  ScanPublisher publisher_;
  Session session_;
  runtime::Stream* stream_ = nullptr;
  std::uint64_t& lost_;
  std::uint64_t& rejected_;
  runtime::Timer timer_;
};

}  // namespace usher::lms100
