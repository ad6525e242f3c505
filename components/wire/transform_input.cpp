#include "wire/transform_input.hpp"

#include <algorithm>

#include "wire/frames.hpp"

namespace usher::wire {

namespace {
constexpr std::size_t kMaxWaiting = 16;
constexpr auto kPatience = std::chrono::milliseconds(100);
constexpr auto kFuture = std::chrono::seconds(1);  // map -> odom is valid for a while ahead
constexpr int kWriters = 8;                        // of tf and tf_static on one robot
}  // namespace

TransformInput::TransformInput(runtime::Host& host)
    : host_(host),
      dropped_(host.health().counter("tf: dropped")),
      refused_(host.health().counter("tf: refused")),
      moving_(host.input(topics::kTf, {.depth = 4 * kWriters, .optional = true},
                         [this](const auto& message, const auto&) { take(message, false); })),
      fixed_(host.input(topics::kTfStatic, {.depth = 4 * kWriters, .optional = true},
                        [this](const auto& message, const auto&) { take(message, true); })) {}

Result<geometry::Pose2> TransformInput::lookup_planar(const std::string& target,
                                                      const std::string& source,
                                                      runtime::Time stamp) const {
  const auto pose = lookup(target, source, stamp);
  if (!pose) return Error{pose.error()};
  return geometry::to_plane(*pose);
}

std::optional<geometry::Pose2> TransformInput::newest_planar(const std::string& target,
                                                             const std::string& source,
                                                             runtime::Duration most) const {
  const auto newest = buffer_.newest(target, source);
  if (!newest || host_.now() - runtime::Time(*newest) > most) return std::nullopt;
  const auto pose = lookup_planar(target, source, runtime::Time(*newest));
  return pose ? std::optional(*pose) : std::nullopt;
}

void TransformInput::take(const tf2_msgs::msg::TFMessage& message, bool fixed) {
  for (const auto& transform : message.transforms()) {
    // Their number grows for ever, and the buffer's is limited.
    if (transform.child_frame_id().starts_with(frames::kPerson)) continue;
    const auto pose = from_message(transform.transform());
    if (!pose) {
      ++refused_;
      continue;
    }
    const auto& parent = transform.header().frame_id();
    const auto& child = transform.child_frame_id();
    const auto stamp = from_message(transform.header().stamp()).time_since_epoch();
    // A stamp from the future would make all later ones old.
    if (!fixed && stamp > (host_.now() + kFuture).time_since_epoch()) {
      ++refused_;
      continue;
    }
    const Status added =
        fixed ? buffer_.add_static(parent, child, *pose) : buffer_.add(parent, child, stamp, *pose);
    if (!added) ++refused_;
  }
  serve();
}

void TransformInput::when_known(const std::string& target, const std::string& source,
                                runtime::Time stamp,
                                std::function<void(const geometry::Pose3&)> work) {
  if (waiting_.size() == kMaxWaiting) {
    // A source that floods pays for itself.
    const auto own = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const Waiting& other) { return other.source == source; });
    waiting_.erase(own == waiting_.end() ? waiting_.begin() : own);
    ++dropped_;
  }
  waiting_.push_back({target, source, stamp, host_.now(), std::move(work)});
  serve();
}

void TransformInput::serve() {
  for (std::size_t i = 0; i < waiting_.size();) {
    const auto at = waiting_.begin() + static_cast<std::ptrdiff_t>(i);
    const bool first = std::none_of(
        waiting_.begin(), at, [&](const Waiting& earlier) { return earlier.source == at->source; });
    const auto pose = first ? lookup(at->target, at->source, at->stamp)
                            : Result<geometry::Pose3>(Error{"others wait before it"});
    if (pose) {
      const auto work = std::move(at->work);
      waiting_.erase(at);
      work(*pose);
    } else if (host_.now() - at->since > kPatience) {
      waiting_.erase(at);
      ++dropped_;
    } else {
      ++i;
    }
  }
}

}  // namespace usher::wire
