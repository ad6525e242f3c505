#include "operations/experiments/run_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "wire/conversions.hpp"

namespace usher::operations {

namespace {
constexpr double kPersonStep = 0.1;  // [m] between two points of a person's way

std::string state_of(const usher_msgs::msg::NavigateStatus& status) {
  constexpr std::array kNames = {"idle",   "active",    "waiting", "succeeded",
                                 "failed", "cancelled", "replaced"};
  const std::string name = status.state() < kNames.size() ? kNames[status.state()] : "?";
  return status.reason().empty() ? name : name + ": " + status.reason();
}
}  // namespace

void RunRecord::take(const usher_sim_msgs::msg::GroundTruth& truth) {
  const auto pose = wire::to_planar(truth.pose());
  if (!pose) return;
  const geometry::Pose2 to_robot = geometry::inverse(*pose);
  double nearest = std::numeric_limits<double>::infinity(), bearing = 0.0;
  for (const auto& person : truth.people()) {
    const geometry::Point2 seen = to_robot * geometry::Point2(person.x(), person.y());
    if (seen.x() < 0.0 || seen.norm() >= nearest) continue;
    nearest = seen.norm();
    bearing = std::atan2(seen.y(), seen.x());
  }
  samples_.push_back({wire::from_message(truth.header().stamp()), *pose, truth.v(), truth.pitch(),
                      truth.clearance(), wanted_.twist().linear().x(),
                      wanted_.twist().angular().z(), command_.v(), command_.w(), whiskers_, nearest,
                      bearing, navigation_ ? state_of(*navigation_) : ""});
  if (truth.contacts() > contacts_) {
    // What it touches holds it: its speed was that of the sample before.
    const double speed = samples_[samples_.size() > 1 ? samples_.size() - 2 : 0].v;
    char where[120];
    std::snprintf(where, sizeof where, " at (%.2f, %.2f), %.2f m/s, %.1f s",
                  truth.pose().position().x(), truth.pose().position().y(), speed,
                  runtime::seconds(samples_.back().stamp - samples_.front().stamp));
    contact_with_ = truth.contact_with() + where;
  }
  contacts_ = truth.contacts();
  touches_ = truth.touches();
  worst_lag_ = std::max(worst_lag_, truth.lag());
  for (const auto& person : truth.people()) {
    const geometry::Point2 position(person.x(), person.y());
    auto& way = people_[person.id()];
    if (way.empty() || (way.back() - position).norm() > kPersonStep) way.push_back(position);
    if (!person.name().empty()) named_[person.name()] = position;
  }
}

void RunRecord::take(const geometry_msgs::msg::PoseWithCovarianceStamped& estimate) {
  if (const auto pose = wire::to_planar(estimate.pose().pose())) {
    estimates_.emplace_back(wire::from_message(estimate.header().stamp()), *pose);
  }
}

void RunRecord::take(const nav_msgs::msg::Path& plan) {
  const auto path = wire::from_message(plan);
  if (!path || path->empty()) return;
  auto& points = plans_.emplace_back();
  for (const auto& pose : *path) points.push_back(pose.position());
}

void RunRecord::take(const usher_msgs::msg::NavigateStatus& status) {
  using namespace usher_msgs::msg::GoalStatus_Constants;
  const runtime::Time stamp = wire::from_message(status.header().stamp());
  if (status.state() == STATE_ACTIVE || status.state() == STATE_WAITING) {
    if (!active_from_) active_from_ = stamp;
    active_until_ = stamp;
  }
  reached_ = reached_ || status.state() == STATE_SUCCEEDED;
  navigation_ = status;
}

void RunRecord::take(const usher_msgs::msg::DialogueScreen& screen) {
  if (dialogue_.empty() || dialogue_.back() != screen.state()) dialogue_.push_back(screen.state());
  screen_ = screen;
}

void RunRecord::take(const geometry_msgs::msg::TwistStamped& wanted) { wanted_ = wanted; }

void RunRecord::take(const usher_msgs::msg::DriveCommand& command) { command_ = command; }

void RunRecord::take(const usher_msgs::msg::Whiskers& whiskers) {
  whiskers_.clear();
  const std::pair<bool, const char*> corners[] = {{whiskers.front_left(), "fl "},
                                                  {whiskers.front_right(), "fr "},
                                                  {whiskers.back_left(), "bl "},
                                                  {whiskers.back_right(), "br "}};
  for (const auto& [touched, name] : corners) whiskers_ += touched ? name : "";
}

std::optional<geometry::Point2> RunRecord::person(const std::string& name) const {
  const auto found = named_.find(name);
  if (found == named_.end()) return std::nullopt;
  return found->second;
}

std::optional<geometry::Pose2> RunRecord::truth() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.back().truth;
}

std::optional<geometry::Pose2> RunRecord::truth_at(runtime::Time stamp) const {
  const auto after = std::lower_bound(
      samples_.begin(), samples_.end(), stamp,
      [](const Sample& sample, runtime::Time wanted) { return sample.stamp < wanted; });
  if (after == samples_.begin() || after == samples_.end()) return std::nullopt;
  const auto before = after - 1;
  return geometry::interpolate(
      before->truth, after->truth,
      runtime::seconds(stamp - before->stamp) / runtime::seconds(after->stamp - before->stamp));
}

std::vector<RunRecord::Error> RunRecord::localization_errors() const {
  std::vector<Error> errors;
  for (const auto& [stamp, estimate] : estimates_) {
    const auto truth = truth_at(stamp);
    if (!truth) continue;
    errors.push_back({stamp, geometry::distance(*truth, estimate),
                      std::abs(geometry::shortest_turn(truth->yaw, estimate.yaw))});
  }
  return errors;
}

RunRecord::Summary RunRecord::summary() const {
  Summary s;
  s.contacts = contacts_;
  s.touches = touches_;
  s.contact_with = contact_with_;
  s.worst_lag = worst_lag_;
  s.smallest_clearance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto& sample = samples_[i];
    const bool active =
        active_from_ && sample.stamp >= *active_from_ && sample.stamp <= *active_until_;
    s.smallest_clearance = std::min(s.smallest_clearance, sample.clearance);
    if (i > 0 && active) s.path += geometry::distance(samples_[i - 1].truth, sample.truth);
  }
  if (active_from_) s.seconds = runtime::seconds(*active_until_ - *active_from_);
  s.mean_speed = s.seconds > 0.0 ? s.path / s.seconds : 0.0;
  for (const Error& error : localization_errors()) {
    s.localization_mean += error.distance;
    s.localization_yaw_mean += error.yaw;
    s.localization_max = std::max(s.localization_max, error.distance);
    ++s.estimates;
  }
  if (s.estimates > 0) {
    s.localization_mean /= static_cast<double>(s.estimates);
    s.localization_yaw_mean /= static_cast<double>(s.estimates);
  }
  return s;
}

std::string run_csv(const RunRecord& record) {
  std::string out =
      "t,x,y,yaw,v,pitch,clearance,wanted_v,wanted_w,commanded_v,commanded_w,person,person_bearing,"
      "whiskers,"
      "state\n";
  char line[240];
  for (const auto& sample : record.samples()) {
    std::snprintf(line, sizeof(line),
                  "%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,",
                  runtime::seconds(sample.stamp - record.samples().front().stamp), sample.truth.x,
                  sample.truth.y, sample.truth.yaw, sample.v, sample.pitch, sample.clearance,
                  sample.wanted_v, sample.wanted_w, sample.commanded_v, sample.commanded_w,
                  sample.person, sample.person_bearing);
    out += line + sample.whiskers + (",\"" + sample.state + "\"\n");
  }
  return out;
}

}  // namespace usher::operations
