#pragma once

#include <memory>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::runtime::test {

/// Answers each cmd_vel/manual with a cmd_vel/interaction of the same velocity times `gain`;
/// linear.y becomes the age of the question when its handler ran [s], angular.x the number of
/// answers before. An angular.z of 666 is a fault.
class EchoComponent : public Component {
 public:
  explicit EchoComponent(Host& host)
      : host_(host),
        gain_(host.parameters().number("gain", "-", {0.1, 10.0}, 1.0, "Factor on the velocity.")),
        answer_(host.output(topics::kCmdVelInteraction)),
        question_(host.input(topics::kCmdVelManual, {.max_age = {}, .optional = true},
                             [this](const geometry_msgs::msg::TwistStamped& question,
                                    const SampleInfo&) { answer(question); })) {
    host.health().set(HealthState::kOk);
  }

 private:
  void answer(const geometry_msgs::msg::TwistStamped& question) {
    if (question.twist().angular().z() == 666.0) host_.fault("asked to fail");
    const auto& stamp = question.header().stamp();
    const Time asked{std::chrono::seconds(stamp.sec()) + Duration(stamp.nanosec())};
    geometry_msgs::msg::TwistStamped reply = question;
    reply.twist().linear().x(gain_ * question.twist().linear().x());
    reply.twist().linear().y(seconds(host_.now() - asked));
    reply.twist().angular().x(count_++);
    answer_.publish(reply);
  }

  Host& host_;
  double gain_;
  double count_ = 0.0;
  Output<geometry_msgs::msg::TwistStamped> answer_;
  Input<geometry_msgs::msg::TwistStamped> question_;
};

inline geometry_msgs::msg::TwistStamped question(Time now, double v, double w = 0.0) {
  geometry_msgs::msg::TwistStamped twist;
  const auto since_epoch = now.time_since_epoch();
  twist.header().stamp().sec(static_cast<std::int32_t>(since_epoch / std::chrono::seconds(1)));
  twist.header().stamp().nanosec(
      static_cast<std::uint32_t>((since_epoch % std::chrono::seconds(1)).count()));
  twist.twist().linear().x(v);
  twist.twist().angular().z(w);
  return twist;
}

}  // namespace usher::runtime::test
