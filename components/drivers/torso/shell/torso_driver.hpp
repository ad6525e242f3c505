#pragma once

#include <optional>
#include <string>

#include "drivers/torso/core/safe_frame.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::torso {

/// How often the servos are told where to be.
inline constexpr auto kTick = std::chrono::milliseconds(50);

/// What the real and the simulated torso have in common: frames in, made safe, and where the joints
/// are out.
class TorsoDriver {
 public:
  explicit TorsoDriver(runtime::Host& host);

  /// Where the torso is; `reason`: what its board says is wrong, empty when nothing is.
  void measured(const Reading& reading, const std::string& reason);
  /// What it shall be told now; call it every kTick. Nothing until it was measured.
  std::optional<TorsoFrame> step();
  /// The torso fell silent: it may be anywhere when it is back.
  void lost(const std::string& reason);

 private:
  static SafeFrame::Parameters read_parameters(runtime::Host& host);

  runtime::Host& host_;
  SafeFrame safe_;
  std::uint64_t& rejected_;
  runtime::Input<usher_msgs::msg::TorsoFrame> frame_;
  runtime::Output<usher_msgs::msg::TorsoStatus> status_;
};

}  // namespace usher::torso
