#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <string>

#include "runtime/api/host.hpp"

namespace usher::wire {

/// The asking side of a request: repeats it at 5 Hz until it is answered, one after the other in
/// the order of asking, but for what is asked first. Message needs id() and client(); ids grow over
/// restarts too.
template <class Message>
class Repeater {
 public:
  static constexpr std::size_t kMostWaiting = 32;

  Repeater(runtime::Host& host, const topics::Topic<Message>& topic)
      : host_(host),
        output_(host.output(topic)),
        timer_(host.timer("repeat " + std::string(topic.name), kPeriod, [this](auto) {
          if (!waiting_.empty()) output_.publish(waiting_.front());
        })) {}
  Repeater(const Repeater&) = delete;
  Repeater& operator=(const Repeater&) = delete;

  /// An id for the next request.
  std::uint64_t next_id() {
    const auto now = static_cast<std::uint64_t>(host_.now().time_since_epoch().count() / 1000);
    return last_id_ = std::max(last_id_ + 1, now);
  }

  /// Asks; sets the client. When 32 already wait the oldest is given up.
  void ask(Message message) {
    message.client(host_.name());
    if (waiting_.size() == kMostWaiting) waiting_.pop_front();
    waiting_.push_back(std::move(message));
    if (waiting_.size() == 1) output_.publish(waiting_.front());
  }
  /// Asks before all that waits, and gives up those of them that it contradicts: a stop waits for
  /// no answer to something else. When 32 already wait the newest is given up.
  template <class Contradicts>
  void ask_first(Message message, Contradicts contradicts) {
    message.client(host_.name());
    std::erase_if(waiting_, contradicts);
    if (waiting_.size() == kMostWaiting) waiting_.pop_back();
    waiting_.push_front(std::move(message));
    output_.publish(waiting_.front());
  }
  /// An answer names id and client, since ids are unique per client only: true when it ends a
  /// request of ours.
  bool answered(std::uint64_t id, const std::string& client) {
    if (client != host_.name()) return false;
    const auto asked = std::find_if(waiting_.begin(), waiting_.end(),
                                    [id](const Message& each) { return each.id() == id; });
    if (asked == waiting_.end()) return false;
    const bool was_asking = asked == waiting_.begin();
    waiting_.erase(asked);
    if (was_asking && !waiting_.empty()) output_.publish(waiting_.front());
    return true;
  }
  void give_up() { waiting_.clear(); }
  bool waits() const { return !waiting_.empty(); }

 private:
  static constexpr auto kPeriod = std::chrono::milliseconds(200);

  runtime::Host& host_;
  std::uint64_t last_id_ = 0;
  std::deque<Message> waiting_;
  runtime::Output<Message> output_;
  runtime::Timer timer_;
};

}  // namespace usher::wire
