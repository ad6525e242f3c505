#pragma once

#include <cstdint>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::test {

/// For tests of base drivers: a supervisor that grants and a movement_control that commands, each
/// as long as it is told to.
class RightToDrive {
 public:
  explicit RightToDrive(runtime::TestHost& host) : host_(host) {}

  bool grants = true;
  bool commands = true;
  double v = 0.0, w = 0.0;
  const char* commander = "movement_control";
  const char* grantor = "supervisor";

  /// Both speak every 20 ms.
  void run(int ms) {
    for (int at = 0; at < ms; at += 20) {
      if (grants) {
        usher_msgs::msg::DriveGrant grant;
        grant.stamp(wire::to_message(host_.now()));
        grant.granted(true);
        grant.writer(host_.world().writer_guid(topics::kDriveCommand, "movement_control"));
        grant.epoch(1);
        grant.valid_for(0.12F);
        host_.publish(topics::kDriveGrant, grant, grantor);
      }
      if (commands) {
        usher_msgs::msg::DriveCommand command;
        command.stamp(wire::to_message(host_.now()));
        command.epoch(1);
        command.number(++number_);
        command.v(v);
        command.w(w);
        host_.publish(topics::kDriveCommand, command, commander);
      }
      host_.run_for(std::chrono::milliseconds(20));
    }
  }

 private:
  runtime::TestHost& host_;
  std::uint64_t number_ = 0;
};

}  // namespace usher::test
