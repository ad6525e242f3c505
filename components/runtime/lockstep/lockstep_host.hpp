#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "runtime/engine/engine.hpp"
#include "runtime/lockstep/device.hpp"
#include "runtime/lockstep/network.hpp"
#include "runtime/lockstep/schedule.hpp"

namespace usher::runtime {

/// One component in a lockstep world, over all its lives: what is kept survives a crash, as the
/// launcher's run directory does; everything else starts anew.
class LockstepHost {
 public:
  struct Options {
    Duration handler_cost{};                   ///< how long each handler takes
    std::optional<Duration> restart_after;     ///< after a fault or a kill; nothing = stays dead
    std::shared_ptr<LockstepDevice> device{};  ///< at the end of every stream; null = there is none
  };

  LockstepHost(std::uint32_t index, Schedule& schedule, Network& network, ComponentFactory factory,
               ParameterFile file, Options options);
  ~LockstepHost();
  LockstepHost(const LockstepHost&) = delete;
  LockstepHost& operator=(const LockstepHost&) = delete;

  /// A new life. An error names the wrong parameters or says why the constructor ended it.
  Status start();
  void kill();  ///< as kill -9: the others notice when the lease ends
  /// The same, with another time until it is restarted.
  void kill(Duration back_after);
  void stop();  ///< as SIGTERM
  /// No turn until then, while samples go on to arrive: a handler that does not return.
  void hang(Time until);
  /// The host's clock is another one now: what is due by it is planned anew.
  void clock_jumped();

  const ParameterFile& file() const { return file_; }
  /// In its world: "amcl", or "iris/amcl" of a robot in a fleet.
  std::string name() const {
    return file_.robot.empty() ? file_.name : file_.robot + "/" + file_.name;
  }
  bool running() const { return life_ != nullptr; }
  /// Of the last life that ended with one; empty = none.
  const std::string& fault_reason() const { return fault_reason_; }
  std::uint64_t lives() const { return lives_; }
  std::map<std::string, Bytes>& kept() { return kept_; }
  /// Keys that the disk does not give back.
  std::set<std::string>& unreadable() { return unreadable_; }
  /// Where it runs: "laptop", or "iris/laptop".
  std::string host_name() const {
    return file_.robot.empty() ? file_.host : file_.robot + "/" + file_.host;
  }
  /// Null while it is dead.
  Engine* engine();

  /// The schedule's turn for this component is due.
  void turn();

 private:
  class Life;
  class DeadStream;
  class LiveStream;

  Time earliest() const;
  void plan_turn(Time at);
  void end(bool politely);
  void restart_later(Duration delay);

  const std::uint32_t index_;
  Schedule& schedule_;
  Network& network_;
  const ComponentFactory factory_;
  const ParameterFile file_;
  const Options options_;
  std::map<std::string, Bytes> kept_;
  std::set<std::string> unreadable_;
  std::string fault_reason_;
  std::uint64_t lives_ = 0;
  bool in_turn_ = false;
  Time planned_ =
      Time::max();  ///< of the turn that counts; earlier entries of the schedule are stale
  Time busy_until_{}, hung_until_{};
  std::unique_ptr<Life> life_;
};

}  // namespace usher::runtime
