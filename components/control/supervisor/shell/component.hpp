#pragma once

#include <optional>
#include <string>

#include "control/supervisor/core/supervisor.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "wire/keeper.hpp"

namespace usher::supervisor {

/// Grants the right to drive, enables the sources of motion, watches everybody's heartbeats and who
/// writes what the robot moves by.
class SupervisorComponent final : public runtime::Component {
 public:
  explicit SupervisorComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Host& host);
  static void watch_topics(const std::vector<drive::NamedComponent>& manifest,
                           std::vector<WatchedTopic>& watched);
  static Memory remembered(runtime::Host& host, const std::string& kept);
  /// Tells the core who appears on the topic and who leaves it.
  void watch(const std::string& topic);
  Time now() const { return host_.now().time_since_epoch(); }
  void take_request(const usher_msgs::msg::SupervisorRequest& message, const runtime::Guid& writer);
  const std::string& asker(const runtime::Guid& writer);
  void introduce_itself();
  void step();
  void publish_grant(const Decision& decision);
  void publish_enable(const Decision& decision);
  void ask_base(const Decision& decision);
  void publish_status();
  void publish_diagnostics(const SupervisorStatus& status);

  runtime::Host& host_;
  double grant_valid_for_;
  const Parameters parameters_;
  wire::Keeper memory_;
  Supervisor core_;
  std::optional<Memory> told_memory_;  ///< to the keeper
  std::uint64_t& unknown_heartbeats_;
  std::uint64_t& rejected_reports_;
  Time answered_at_{};         ///< the last request that acted at once
  bool answer_later_ = false;  ///< another one, with the next step
  bool told_fault_ = false;    ///< in the status: an operator reads of a fault at once
  std::uint64_t base_request_id_ = 0;
  std::uint8_t base_request_ = 0;
  int status_share_ = 0;
  bool introduced_ = false;

  runtime::Input<usher_msgs::msg::Heartbeat> heartbeat_;
  runtime::Input<usher_msgs::msg::DriveCommand> command_;
  runtime::Input<usher_msgs::msg::BaseStatus> base_;
  runtime::Input<usher_msgs::msg::MovementStatus> movement_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Input<usher_msgs::msg::ExploreStatus> exploration_;
  runtime::Input<usher_msgs::msg::SupervisorRequest> request_;
  runtime::WriterInfo asker_;  ///< who asked last
  runtime::Output<usher_msgs::msg::DriveGrant> grant_;
  runtime::Output<usher_msgs::msg::MovementEnable> enable_;
  runtime::Output<usher_msgs::msg::BaseRequest> base_requests_;
  runtime::Output<usher_msgs::msg::SupervisorStatus> status_;
  runtime::Output<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  runtime::Timer timer_;
};

}  // namespace usher::supervisor
