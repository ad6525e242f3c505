#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "idl/topic.hpp"
#include "runtime/api/host.hpp"
#include "runtime/lockstep/lockstep_host.hpp"
#include "runtime/lockstep/network.hpp"
#include "runtime/lockstep/schedule.hpp"

namespace usher::runtime {

/// Many components in one thread on a virtual clock: seeded, deterministic, as fast as the machine
/// allows.
///
///     LockstepWorld world({.network = {.seed = 7}});
///     world.add(component_factory<Amcl>("amcl"), *read_parameter_file("amcl.yaml"));
///     world.observe(topics::kAmclPose, [&](const auto& pose, const SampleInfo& info) { ... });
///     world.publish(topics::kInitialPose, start_pose);
///     world.run_for(std::chrono::seconds(60));
///
/// Several robots of a fleet may live in it (ParameterFile::robot): each has its own topics, those
/// of the fleet are common, and a component is called "robot/name". Their hosts must have different
/// names. What looks or speaks is told whose topic is meant; without it, that of the one robot that
/// is in no fleet, or of all.
///
/// The same world and seed give the same digest of everything that was written. The order of what
/// happens at one moment: actions (in the order in which they were planned), deliveries (likewise),
/// turns (in the order of the components). Within a turn time stands still for the component, and
/// for the world unless a handler cost is declared.
class LockstepWorld {
 public:
  struct Options {
    NetworkOptions network;
    Time start = Time(std::chrono::seconds(1'700'000'000));
  };

  LockstepWorld();
  explicit LockstepWorld(const Options& options);
  ~LockstepWorld();
  LockstepWorld(const LockstepWorld&) = delete;
  LockstepWorld& operator=(const LockstepWorld&) = delete;

  // --- What is in it
  /// Starts a component now, under the name, host and parameters of its file. An error names the
  /// wrong parameters or says why the constructor ended the component; it stays in the world and
  /// may be started again.
  Status add(ComponentFactory factory, ParameterFile file, LockstepHost::Options options = {});
  /// How far the clock of a host is ahead of the world's. Before its components are added.
  void set_clock(const std::string& host, Duration ahead) { network_.set_clock(host, ahead); }
  /// Both directions; the same host twice means inside it.
  void set_link(const std::string& a, const std::string& b, const Link& link) {
    network_.set_link(a, b, link);
  }

  // --- What happens to it. In an observer or a handler these wait until the running turn is over.
  void kill(const std::string& name);  ///< kill -9
  /// The same; back after that time, whatever the component's own restart_after.
  void kill(const std::string& name, Duration back_after);
  void stop(const std::string& name);   ///< SIGTERM
  void start(const std::string& name);  ///< a new life, with what was kept
  void hang(const std::string& name, Duration duration);
  /// No sample passes between the two hosts.
  void cut(const std::string& a, const std::string& b, Time from, Time until) {
    network_.cut(a, b, from, until);
  }
  /// No sample passes from the one host to the other.
  void cut_one_way(const std::string& from_host, const std::string& to_host, Time from,
                   Time until) {
    network_.cut(from_host, to_host, from, until, true);
  }
  /// The host's clock goes on from later, as after a suspension.
  void jump_clock(const std::string& host, Duration by);
  /// May change samples of the topic as they are written, by whom ever, or swallow them (false).
  template <class Message>
  void tamper(const topics::Topic<Message>& topic,
              std::type_identity_t<std::function<bool(const Guid& writer, Message&)>> change,
              const std::string& robot = {}) {
    network_.tamper(
        std::string(topic.name),
        [change = std::move(change)](const Guid& writer, Bytes& cdr) {
          const MessageType& type = message_type<Message>();
          const auto read = type.deserialize(cdr);
          if (!read) return true;  // no message: left as it is
          Message message = *static_cast<const Message*>(read.get());
          if (!change(writer, message)) return false;
          cdr.clear();
          return type.serialize(&message, cdr);
        },
        robot);
  }
  void tamper_bytes(const std::string& topic, Network::Tamper change) {
    network_.tamper(topic, std::move(change));
  }
  /// Anything, at a time of the world; before deliveries and turns of the same moment.
  void at(Time time, std::function<void()> action) {
    schedule_.add_action(time, std::move(action));
  }

  // --- Looking and speaking
  /// Every sample of the topic at the moment of its writing, by whom ever; info has the world's
  /// time.
  template <class Message>
  void observe(
      const topics::Topic<Message>& topic,
      std::type_identity_t<std::function<void(const Message&, const SampleInfo&)>> observer,
      const std::string& robot = {}) {
    network_.observe(
        std::string(topic.name), message_type<Message>(),
        [observer = std::move(observer)](const std::shared_ptr<const void>& message,
                                         const SampleInfo& info) {
          observer(*static_cast<const Message*>(message.get()), info);
        },
        robot);
  }
  void observe_all(std::function<void(const WrittenSample&)> observer) {
    network_.observe_all(std::move(observer));
  }
  /// Writes as a participant that is no component and that everybody knows from the start.
  template <class Message>
  void publish(const topics::Topic<Message>& topic, const std::type_identity_t<Message>& message,
               const std::string& participant = "test", const std::string& host = {},
               const std::string& robot = {}) {
    publish(declaration_of(topic), &message, {participant, host, robot});
  }
  /// Bytes that need not be a message, for what a broken or hostile writer sends.
  template <class Message>
  void publish_bytes(const topics::Topic<Message>& topic, const Bytes& cdr,
                     const std::string& participant = "test", const std::string& host = {}) {
    write_bytes(declaration_of(topic), cdr, {participant, host, {}});
  }
  /// Of the writer that publish() uses; opens it.
  template <class Message>
  Guid writer_guid(const topics::Topic<Message>& topic, const std::string& participant = "test",
                   const std::string& host = {}) {
    return outsider_writer(declaration_of(topic), {participant, host, {}}).guid();
  }
  /// The participant of publish() says goodbye; publishing again makes a new one.
  void leave(const std::string& participant, const std::string& host = {});
  /// Name of the participant that owns a writer; empty for a GUID that was never given.
  const std::string& participant_of(const Guid& writer) const {
    return network_.participant_of(writer);
  }

  // --- Time
  Time now() const { return schedule_.now(); }
  Duration elapsed() const { return now() - start_; }
  /// Everything that is due until then, that moment included.
  void run_until(Time time);
  void run_for(Duration duration) { run_until(now() + duration); }

  // --- Results
  /// Of topic, writer, time and bytes of everything that was written, in order.
  std::uint64_t digest() const { return network_.digest(); }
  std::uint64_t written() const { return network_.written(); }
  std::uint64_t lost_on_links() const { return network_.lost(); }
  bool running(const std::string& name) const { return host(name).running(); }
  /// Why the component's last life ended with a fault; empty when none did.
  const std::string& fault_reason(const std::string& name) const {
    return host(name).fault_reason();
  }
  std::uint64_t lives(const std::string& name) const { return host(name).lives(); }
  /// What the component keeps over its lives.
  std::map<std::string, Bytes>& kept(const std::string& name) { return host(name).kept(); }
  /// Of that, what the disk does not give back.
  std::set<std::string>& unreadable(const std::string& name) { return host(name).unreadable(); }
  /// In the order in which they were added.
  std::vector<std::string> components() const;

 private:
  struct Speaker {
    std::string participant, host, robot;
    auto operator<=>(const Speaker&) const = default;
  };
  struct Outsider {
    Network::ParticipantId id;
    std::map<std::string, Transport::Writer*> writers;  ///< by topic and type
  };

  template <class Message>
  static OutputDeclaration declaration_of(const topics::Topic<Message>& topic) {
    return {std::string(topic.name), &message_type<Message>(), topic.writer_qos(), topic.rate_hz,
            topic.scope};
  }
  LockstepHost& host(const std::string& name) const;
  void when_idle(std::function<void()> action);
  Transport::Writer& outsider_writer(const OutputDeclaration& declaration, const Speaker& speaker);
  void publish(const OutputDeclaration& declaration, const void* message, const Speaker& speaker);
  void write_bytes(const OutputDeclaration& declaration, Bytes cdr, const Speaker& speaker);

  const Time start_;
  Schedule schedule_;
  Network network_;
  std::vector<std::unique_ptr<LockstepHost>> hosts_;
  std::map<Speaker, Outsider> outsiders_;
  bool turning_ = false;
};

}  // namespace usher::runtime
