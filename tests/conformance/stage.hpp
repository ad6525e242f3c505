#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::conformance {

using runtime::Bytes;
using runtime::Component;
using runtime::Duration;
using runtime::Host;
using runtime::Time;
using Message = std_msgs::msg::Header;  ///< stamp and a text: all that the laws need
using Topic = topics::Topic<Message>;

/// Somebody who publishes and is no component.
struct Sender {
  std::string name = "outsider";
  std::string host = "here";
};

/// Where the laws are judged: components on real hosts of one kind, and outsiders that are no
/// components. Each host has one implementation (lockstep_stage.cpp, dds_stage.cpp); which one is
/// linked decides what is judged.
class Stage {
 public:
  struct Role {
    std::string name = "subject";
    std::string host = "here";
    std::uint64_t seed = 1;
    bool critical = false;
    Duration work{};         ///< how long work() takes inside a handler
    std::string parameters;  ///< YAML below `parameters:`
    std::string robot{};     ///< in a fleet; the component is called "robot/name" then
  };
  using Make = std::function<std::unique_ptr<Component>(Host&)>;

  virtual ~Stage() = default;

  /// Makes a component; a second start of a name is a restart.
  virtual Status start(const Role& role, Make make) = 0;
  virtual void stop(const std::string& name) = 0;
  /// Nothing while it runs; else what a program would return: 0, 3.
  virtual std::optional<int> exit_code(const std::string& name) = 0;
  /// The dispatcher of the component is stuck for so long, as in a handler that does not return.
  virtual void hold(const std::string& name, Duration duration) = 0;
  /// Called in a handler: takes the time that the role declares.
  virtual void work(const Role& role) = 0;

  /// Publishes once there is a reader. The samples of one call leave together.
  virtual void publish_all(const Topic& topic, const std::vector<Message>& messages,
                           const Sender& sender) = 0;
  void publish(const Topic& topic, const Message& message, const Sender& sender = {}) {
    publish_all(topic, {message}, sender);
  }
  /// The same with bytes that need not be a message.
  virtual void publish_bytes(const Topic& topic, const Bytes& cdr) = 0;
  /// The sender says goodbye.
  virtual void leave(const Sender& sender) = 0;
  /// Cuts the link between two hosts from now on for so long; false when this stage cannot.
  virtual bool cut(const std::string& a, const std::string& b, Duration duration) = 0;

  virtual Time now() const = 0;
  /// Lets time pass until the condition holds; false when it did not within `limit`.
  virtual bool run_until(const std::function<bool()>& condition, Duration limit) = 0;
  void run_for(Duration duration) {
    run_until([] { return false; }, duration);
  }
  /// Everybody has found everybody.
  virtual void settle() = 0;
  /// Heartbeats of a component so far, oldest first.
  virtual std::vector<usher_msgs::msg::Heartbeat> heartbeats(const std::string& name) = 0;
  /// How late a real machine may be; zero on a virtual clock.
  virtual Duration tolerance() const = 0;
};

std::unique_ptr<Stage> make_stage();

/// What handlers saw, written by dispatchers and read by the test.
template <class Entry>
class Log {
 public:
  void add(Entry entry) {
    const std::lock_guard lock(mutex_);
    entries_.push_back(std::move(entry));
  }
  std::vector<Entry> all() const {
    const std::lock_guard lock(mutex_);
    return entries_;
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;
};

inline Message message(const std::string& text, Time stamp = {}) {
  Message result;
  const auto since_epoch = stamp.time_since_epoch();
  const auto whole = std::chrono::floor<std::chrono::seconds>(since_epoch);
  result.stamp().sec(static_cast<std::int32_t>(whole.count()));
  result.stamp().nanosec(static_cast<std::uint32_t>((since_epoch - whole).count()));
  result.frame_id(text);
  return result;
}
inline Message message(int number, Time stamp = {}) {
  return message(std::to_string(number), stamp);
}

}  // namespace usher::conformance
