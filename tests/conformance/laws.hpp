#pragma once

// The host laws, judged over whichever stage is linked. Where a real machine may be late, the stage
// says by how much; no law is weaker for it, since each is stated on what the component itself can
// observe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "conformance/stage.hpp"

namespace usher::conformance {

using runtime::HealthState;
using runtime::Input;
using runtime::Output;
using runtime::SampleInfo;
using runtime::Timer;
using runtime::WriterInfo;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

inline constexpr int kDepth = 8;
inline constexpr Topic kEvents{"test/events", topics::Kind::kEvent, kDepth, 0, "*", ""};
inline constexpr Topic kOthers{"test/others", topics::Kind::kEvent, kDepth, 0, "*", ""};
inline constexpr Topic kReplies{"test/replies", topics::Kind::kEvent, 64, 0, "*", ""};
inline constexpr Topic kLatched{"test/latched", topics::Kind::kLatched, 1, 0, "*", ""};
inline constexpr Duration kSoon = seconds(5);  ///< limit of waiting for what comes at once

/// A component made of a function: whatever it returns lives as long as the component.
class Scripted final : public Component {
 public:
  explicit Scripted(std::shared_ptr<void> state) : state_(std::move(state)) {}

 private:
  std::shared_ptr<void> state_;
};
template <class State>
Stage::Make scripted(std::function<void(Host&, State&)> script) {
  return [script](Host& host) {
    auto state = std::make_shared<State>();
    script(host, *state);
    return std::make_unique<Scripted>(state);
  };
}
struct Nothing {};

class HostLaw : public ::testing::Test {
 protected:
  Status start(const Stage::Role& role, Stage::Make make) {
    return stage_->start(role, std::move(make));
  }
  void start(Stage::Make make) { ASSERT_TRUE(start({}, std::move(make)).ok()); }
  template <class Entry>
  bool wait_for(const Log<Entry>& log, std::size_t count) {
    return stage_->run_until([&] { return log.size() >= count; }, kSoon);
  }

  /// An empty one before the first.
  usher_msgs::msg::Heartbeat newest_heartbeat(const std::string& name) {
    const auto beats = stage_->heartbeats(name);
    return beats.empty() ? usher_msgs::msg::Heartbeat() : beats.back();
  }
  /// What handlers refer to lives longer than the stage on which they run.
  template <class T, class... Arguments>
  T& make(Arguments&&... arguments) {
    auto made = std::make_shared<T>(std::forward<Arguments>(arguments)...);
    props_.push_back(made);
    return *made;
  }

 private:
  std::vector<std::shared_ptr<void>> props_;

 protected:
  std::unique_ptr<Stage> stage_ = make_stage();
};

struct Seen {
  std::string text;
  Time now{};
  SampleInfo info{};
};
inline std::vector<std::string> texts(const std::vector<Seen>& all) {
  std::vector<std::string> result;
  for (const Seen& each : all) result.push_back(each.text);
  return result;
}

}  // namespace usher::conformance
