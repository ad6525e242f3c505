#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "drivers/base_obedience/shell/obedient_base.hpp"

namespace usher::drive {

/// A base at the other end of a stream: feeds a Link with what arrives and sends in every cycle
/// what it wants to say. A velocity never waits behind an older one: while the line is blocked the
/// newest takes the place of what was not sent.
///
/// A Link is a driver's core: opened, closed, received, cycle, velocity_only, velocity, mode,
/// reason (see segway_rmp/core/link.hpp).
template <class Link, class Feedback>
class BaseLine {
 public:
  struct Options {
    std::string address;  ///< default of the parameter of this name
    std::string text;     ///< of that parameter
    runtime::Duration cycle;
    runtime::StreamGuard guard{};
    std::function<void(const Feedback&)> take;
    std::function<void(const std::string&)> lost;
    std::function<void()> heard = [] {};  ///< bytes came, whole reports or not
  };

  BaseLine(runtime::Host& host, Link link) : host_(host), link_(std::move(link)) {}

  Link& link() { return link_; }
  /// What the link shall make of it in its next cycle.
  void want(const geometry::Twist2& twist) { wanted_ = twist; }

  /// What its guard shall tell the base for so long where this driver hangs or ends.
  void last_will(const geometry::Twist2& twist, runtime::Duration lasts) {
    will_ = twist;
    will_lasts_ = lasts;
  }

  /// To be called once.
  void open(Options options) {
    options_ = std::move(options);
    stream_ =
        &host_.open_stream(host_.parameters().text("address", options_.address, options_.text),
                           {.on_open = [this] { link_.opened(now()); },
                            .on_bytes = [this](auto bytes) { received(bytes); },
                            .on_close =
                                [this](const std::string& reason) {
                                  link_.closed();
                                  options_.lost(reason);
                                },
                            .guard = options_.guard});
    timer_ = host_.timer("line", options_.cycle, [this](auto) { cycle(); });
  }

 private:
  Time now() const { return host_.now().time_since_epoch(); }
  void received(std::span<const std::uint8_t> bytes) {
    link_.received(bytes, now(), [this](const Feedback& feedback) { options_.take(feedback); });
    options_.heard();
  }
  void cycle() {
    const bool replaceable = link_.velocity_only();
    const auto bytes = link_.cycle(wanted_, now());
    if (!bytes.empty() && replaceable) stream_->write_latest(bytes);
    if (!bytes.empty() && !replaceable) stream_->write(bytes);
    const auto will = link_.velocity(will_);
    stream_->last_will({will.data(), will.size()}, will_lasts_);
    using Mode = decltype(link_.mode(now()));
    if (link_.mode(now()) == Mode::kDisconnected) options_.lost(link_.reason());
  }

  runtime::Host& host_;
  Link link_;
  Options options_;
  geometry::Twist2 wanted_, will_;
  runtime::Duration will_lasts_{};
  runtime::Stream* stream_ = nullptr;
  runtime::Timer timer_;
};

}  // namespace usher::drive
