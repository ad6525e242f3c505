#include "foundation/geometry/transform_buffer.hpp"

#include <algorithm>
#include <array>

namespace usher::geometry {

namespace {
constexpr std::size_t kMaxFrames = 64;
constexpr std::size_t kMaxSamples = 2048;
constexpr double kUnitTolerance = 1e-3;
// Of samples nearer to each other the difference is no rate.
constexpr TransformBuffer::Stamp kShortestStep = std::chrono::milliseconds(1);

double in_seconds(TransformBuffer::Stamp d) { return std::chrono::duration<double>(d).count(); }

bool alike(const Pose3& a, const Pose3& b) {
  constexpr double kSame = 1e-6;  // [m] and [rad]
  return (a.translation - b.translation).norm() < kSame &&
         a.rotation.angularDistance(b.rotation) < kSame;
}

std::string quoted(std::string_view name) { return "'" + std::string(name) + "'"; }
}  // namespace

Status TransformBuffer::check(std::string_view parent, std::string_view child, bool fixed,
                              const Pose3& pose) const {
  if (parent.empty() || child.empty()) return Error{"transform without a frame name"};
  if (parent == child) return Error{"frame " + quoted(child) + " cannot be its own parent"};
  if (!pose.finite()) return Error{"transform to " + quoted(child) + " is not finite"};
  if (std::abs(pose.rotation.norm() - 1.0) > kUnitTolerance) {
    return Error{"rotation to " + quoted(child) + " must have unit length, got " +
                 std::to_string(pose.rotation.norm())};
  }
  const auto found = frames_.find(child);
  if (found == frames_.end()) {
    if (frames_.size() >= kMaxFrames)
      return Error{"more than 64 frames; " + quoted(child) + " is one too many"};
  } else if (found->second.parent != parent) {
    return Error{"frame " + quoted(child) + " has the parent " + quoted(found->second.parent) +
                 ", not " + quoted(parent)};
  } else if (found->second.fixed != fixed) {
    return Error{"frame " + quoted(child) + (fixed ? " moves" : " never moves")};
  }
  return {};
}

Status TransformBuffer::add(std::string_view parent, std::string_view child, Stamp stamp,
                            const Pose3& parent_T_child) {
  if (auto status = check(parent, child, false, parent_T_child); !status) return status;
  auto& frame = frames_[std::string(child)];
  frame.parent = parent;
  if (!frame.samples.empty() && stamp < frame.samples.back().stamp) {
    return Error{"transform to " + quoted(child) + " is older than the newest by " +
                 std::to_string(in_seconds(frame.samples.back().stamp - stamp)) + " s"};
  }
  if (!frame.samples.empty() && stamp == frame.samples.back().stamp) frame.samples.pop_back();
  frame.samples.push_back({stamp, parent_T_child});
  while (frame.samples.front().stamp < stamp - memory_ || frame.samples.size() > kMaxSamples)
    frame.samples.pop_front();
  return {};
}

Status TransformBuffer::add_static(std::string_view parent, std::string_view child,
                                   const Pose3& parent_T_child) {
  if (auto status = check(parent, child, true, parent_T_child); !status) return status;
  auto& frame = frames_[std::string(child)];
  if (!frame.samples.empty() && !alike(frame.samples.front().pose, parent_T_child))
    return Error{"frame " + quoted(child) + " never moves, and has another place"};
  frame.parent = parent;
  frame.fixed = true;
  frame.samples.assign(1, {Stamp{0}, parent_T_child});
  return {};
}

Result<Pose3> TransformBuffer::at(const std::string& child, const Frame& frame, Stamp stamp) const {
  const auto& samples = frame.samples;
  if (frame.fixed) return samples.front().pose;
  if (stamp < samples.front().stamp) {
    return Error{quoted(child) + " is known from " +
                 std::to_string(in_seconds(samples.front().stamp - stamp)) +
                 " s after the wanted time"};
  }
  if (stamp > samples.back().stamp + reach_) {
    return Error{quoted(child) + " is known until " +
                 std::to_string(in_seconds(stamp - samples.back().stamp)) +
                 " s before the wanted time"};
  }
  if (samples.size() == 1) return samples.front().pose;
  auto after =
      std::lower_bound(samples.begin(), samples.end(), stamp,
                       [](const Sample& sample, Stamp wanted) { return sample.stamp < wanted; });
  if (after == samples.begin()) return after->pose;
  if (after == samples.end()) --after;
  const auto& a = *(after - 1);
  const auto& b = *after;
  if (stamp > b.stamp && b.stamp - a.stamp < kShortestStep) return b.pose;
  return interpolate(a.pose, b.pose, in_seconds(stamp - a.stamp) / in_seconds(b.stamp - a.stamp));
}

Result<Pose3> TransformBuffer::lookup(std::string_view target, std::string_view source,
                                      Stamp stamp) const {
  // Both frames' chains to the root; the deepest common frame joins them.
  std::array<std::string_view, kMaxFrames + 1> targets;
  std::size_t count = 0;
  for (std::string_view name = target;;) {
    targets[count++] = name;
    const auto found = frames_.find(name);
    if (found == frames_.end() || count == targets.size()) break;
    name = found->second.parent;
  }
  const auto end = targets.begin() + static_cast<std::ptrdiff_t>(count);

  Pose3 common_T_source;
  std::string_view name = source;
  std::size_t steps = 0;
  auto common = std::find(targets.begin(), end, name);
  while (common == end) {
    const auto found = frames_.find(name);
    if (found == frames_.end() || ++steps > kMaxFrames) {
      return Error{"frames " + quoted(target) + " and " + quoted(source) + " are not connected"};
    }
    const auto pose = at(found->first, found->second, stamp);
    if (!pose) return Error{pose.error()};
    common_T_source = *pose * common_T_source;
    name = found->second.parent;
    common = std::find(targets.begin(), end, name);
  }
  Pose3 common_T_target;
  for (auto step = common; step != targets.begin();) {
    const auto found = frames_.find(*--step);
    const auto pose = at(found->first, found->second, stamp);
    if (!pose) return Error{pose.error()};
    common_T_target = common_T_target * *pose;
  }
  return inverse(common_T_target) * common_T_source;
}

Result<TransformBuffer::Stamp> TransformBuffer::newest(std::string_view target,
                                                       std::string_view source) const {
  // Walks up from both ends until the chains meet; a chain that ends in the root without meeting is
  // not connected.
  std::map<std::string_view, Stamp>
      seen;  // frame on the target's chain -> newest time common to the chain so far
  Stamp newest = Stamp::max();
  std::string_view name = target;
  for (std::size_t steps = 0; steps <= kMaxFrames; ++steps) {
    seen.emplace(name, newest);
    const auto found = frames_.find(name);
    if (found == frames_.end()) break;
    if (!found->second.fixed) newest = std::min(newest, found->second.samples.back().stamp);
    name = found->second.parent;
  }
  newest = Stamp::max();
  name = source;
  for (std::size_t steps = 0; steps <= kMaxFrames; ++steps) {
    if (const auto meeting = seen.find(name); meeting != seen.end()) {
      newest = std::min(newest, meeting->second);
      return newest == Stamp::max() ? Stamp{0} : newest;
    }
    const auto found = frames_.find(name);
    if (found == frames_.end()) break;
    if (!found->second.fixed) newest = std::min(newest, found->second.samples.back().stamp);
    name = found->second.parent;
  }
  return Error{"frames " + quoted(target) + " and " + quoted(source) + " are not connected"};
}

}  // namespace usher::geometry
