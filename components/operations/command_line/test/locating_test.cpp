#include "operations/command_line/locating.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "idl/topics.hpp"
#include "support/test_domain.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::operations {
namespace {

using runtime::Observer;
using testing::HasSubstr;
namespace confidence = usher_msgs::msg::LocalizationStatus_Constants;

constexpr geometry::Pose2 kBefore{1.0, 2.0, 0.0}, kSaid{8.0, 3.0, 1.5};

/// What an AMCL answers that stood at kBefore, and was sure of it.
class Locating : public testing::Test {
 protected:
  Locating()
      : amcl_(Observer::create({.name = "amcl", .domain = test_domain()}).value()),
        operator_(Observer::create({.name = "operator", .domain = test_domain()}).value()),
        poses_(amcl_->writer(topics::kAmclPose).value()),
        statuses_(amcl_->writer(topics::kLocalizationStatus).value()) {
    tell(kBefore, confidence::STATE_GOOD);
  }
  void tell(const geometry::Pose2& pose, std::uint8_t state, const std::string& reason = {}) {
    const runtime::Time now = amcl_->now();
    geometry_msgs::msg::PoseWithCovarianceStamped message;
    message.header(wire::header(now, frames::kMap));
    message.pose().pose(wire::to_message(pose));
    poses_.write(message);
    usher_msgs::msg::LocalizationStatus status;
    status.header(wire::header(now, frames::kMap));
    status.state(state);
    status.reason(reason);
    statuses_.write(status);
  }
  /// Answers the first pose that it is told with where it is by the scan.
  void answer(const geometry::Pose2& by_scan, std::uint8_t state, const std::string& reason = {},
              const std::optional<geometry::Pose2>& then = {}) {
    auto reader = amcl_->reader(topics::kInitialPose).value();
    thread_ = std::thread([=, this, reader = std::move(reader)]() mutable {
      told_ = reader.take(std::chrono::seconds(5));
      if (!told_) return;
      tell(by_scan, state, reason);
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      if (then) tell(*then, state, reason);
    });
  }
  Result<geometry::Pose2> told() {
    auto result = tell_pose(*operator_, kSaid);
    if (thread_.joinable()) thread_.join();
    return result;
  }

  std::unique_ptr<Observer> amcl_, operator_;
  Observer::Writer<geometry_msgs::msg::PoseWithCovarianceStamped> poses_;
  Observer::Writer<usher_msgs::msg::LocalizationStatus> statuses_;
  std::shared_ptr<const geometry_msgs::msg::PoseWithCovarianceStamped> told_;
  std::thread thread_;
};

TEST_F(Locating, EndsWhereTheScanSays) {
  const geometry::Pose2 by_scan{8.3, 3.1, 1.4};
  answer(by_scan, confidence::STATE_GOOD);
  const auto result = told();
  ASSERT_TRUE(result) << result.error();
  EXPECT_LT(geometry::distance(*result, by_scan), 1e-6);
  ASSERT_TRUE(told_);
  EXPECT_EQ(told_->header().frame_id(), frames::kMap);
  const auto said = wire::to_planar(told_->pose().pose());
  ASSERT_TRUE(said);
  EXPECT_LT(geometry::distance(*said, kSaid), 1e-6);
  EXPECT_TRUE(wire::from_covariance(told_->pose().covariance()));
}

TEST_F(Locating, SaysThatTheMapDoesNotExplainTheScan) {
  answer(kSaid, confidence::STATE_LOST, "the map explains 12 % of the scan");
  const auto result = told();
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr("not sure of it: the map explains 12 % of the scan"));
}

TEST_F(Locating, WaitsUntilScansHaveJudgedThePlace) {
  answer(kSaid, confidence::STATE_GOOD, "", kBefore);
  const auto result = told();
  ASSERT_FALSE(result) << "it took the pose, and went back";
  EXPECT_THAT(result.error(), HasSubstr("its scans do not fit there"));
}

TEST_F(Locating, BelievesNothingThatWasSaidBefore) {
  answer(kBefore, confidence::STATE_GOOD);
  const auto result = told();
  ASSERT_FALSE(result) << "it stayed where it was";
  EXPECT_EQ(result.error(), "its scans do not fit there: it believes to be at 1.00 2.00 0.00");
}

TEST_F(Locating, SaysThatAmclDoesNotAnswer) {
  auto reader = amcl_->reader(topics::kInitialPose).value();
  const auto result = told();
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr("did not take the pose"));
}

TEST_F(Locating, SaysThatNobodyListens) {
  const auto result = told();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), "no amcl reads initialpose");
}

}  // namespace
}  // namespace usher::operations
