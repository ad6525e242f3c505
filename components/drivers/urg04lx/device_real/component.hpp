#pragma once

#include "drivers/urg04lx/core/session.hpp"
#include "drivers/urg04lx/shell/scan_publisher.hpp"

namespace usher::urg04lx {

/// The driver over the scanner's USB or serial line.
class Urg04lxComponent final : public runtime::Component {
 public:
  explicit Urg04lxComponent(runtime::Host& host);

 private:
  Time now() const { return host_.now().time_since_epoch(); }
  void flush();

  runtime::Host& host_;
  ScanPublisher publisher_;
  Session session_;
  runtime::Stream* stream_ = nullptr;
  std::uint64_t& rejected_;
  runtime::Timer timer_;
};

}  // namespace usher::urg04lx
