#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "runtime/engine/transport.hpp"
#include "runtime/lockstep/digest.hpp"
#include "runtime/lockstep/schedule.hpp"

namespace usher::runtime {

/// How samples travel between two hosts, or inside one.
struct Link {
  Duration latency = std::chrono::microseconds(100);  ///< of every sample; at least 1 us
  Duration jitter{};                                  ///< uniform in [0, jitter], on top
  double loss = 0.0;                                  ///< probability per sample and try
};

struct NetworkOptions {
  std::uint64_t seed = 1;
  Duration discovery = std::chrono::milliseconds(30);  ///< until two participants know each other
  Duration lease = std::chrono::milliseconds(800);     ///< of a participant that fell silent
  Link inside_host{std::chrono::microseconds(100)};
  Link between_hosts{std::chrono::microseconds(500)};
};

/// A sample at the moment at which it was written.
struct WrittenSample {
  const std::string& topic;
  const std::string& robot;  ///< of the writer; empty where there is one robot only
  const MessageType& type;
  const Guid& writer;
  std::uint64_t number;
  Time time;  ///< of the world
  const Bytes& cdr;
};

/// DDS as far as components can tell, on a virtual clock: participants that discover each other,
/// writers and readers that match by topic, type and quality of service, reliable samples that are
/// repeated until they arrive or leave the writer's history, best-effort ones that get lost,
/// latched ones that wait for late readers.
class Network {
 public:
  using ParticipantId = std::uint32_t;

  Network(Schedule& schedule, NetworkOptions options);
  ~Network();

  // --- Hosts and links; a host of a robot in a fleet is "robot/host"
  void set_clock(const std::string& host, Duration ahead);
  Duration clock_of(ParticipantId id) const;
  void set_link(const std::string& a, const std::string& b, const Link& link);
  /// The clock of the host and all that runs there goes on from later; it never goes back.
  void jump_clock(const std::string& host, Duration by);
  /// One-way: samples from a do not reach b, those from b reach a. Discovery needs both ways.
  void cut(const std::string& a, const std::string& b, Time from, Time until, bool one_way = false);

  // --- Participants
  /// `instant` ones are discovered at once (tests and experiments that were always there). Topics
  /// of a robot reach those only who joined for the same `robot`.
  ParticipantId join(const std::string& name, const std::string& host, bool instant,
                     const std::string& robot = {});
  /// From now on the others may discover it.
  void announce(ParticipantId id);
  void leave(ParticipantId id);   ///< says so, the others know after the link's latency
  void vanish(ParticipantId id);  ///< the others notice when the lease ends
  bool present(ParticipantId id) const;
  /// Empty for a GUID that was never given.
  const std::string& participant_of(const Guid& writer) const;

  // --- Endpoints; they live as long as the network
  Transport::Reader& open_reader(ParticipantId id, const InputDeclaration& declaration,
                                 Transport::Deliver deliver);
  Transport::Writer& open_writer(ParticipantId id, const OutputDeclaration& declaration);
  void watch_writers(ParticipantId id, const std::string& topic,
                     std::function<void(const WriterInfo&)> event);
  /// When writers of this participant write at the earliest; a component that takes time for its
  /// handlers sets it.
  void set_departure(ParticipantId id, Time departure);

  // --- Tampering
  /// May change the bytes of a sample on its way out, or keep it (false); in the order of adding.
  using Tamper = std::function<bool(const Guid& writer, Bytes& cdr)>;
  void tamper(const std::string& topic, Tamper tamper, const std::string& robot = {});

  // --- Observation
  using Observer =
      std::function<void(const std::shared_ptr<const void>& message, const SampleInfo& info)>;
  /// `robot`: whose, empty for those of a fleet and where there is one robot only.
  void observe(const std::string& topic, const MessageType& type, Observer observer,
               const std::string& robot = {});
  void observe_all(std::function<void(const WrittenSample&)> observer);
  std::uint64_t digest() const { return digest_.value(); }
  std::uint64_t written() const { return written_; }
  std::uint64_t lost() const { return lost_; }  ///< on links and in writers' histories, per reader

  /// The schedule's delivery with this index is due.
  void deliver(std::uint32_t flight);

 private:
  class Reader;
  class Writer;
  struct Participant;
  struct Topic;
  struct Match;
  struct Way;
  struct Watch;
  /// A sample on its way to one reader.
  struct Flight {
    std::shared_ptr<const void> message;
    Guid writer{};
    std::uint64_t number = 0;
    Reader* reader = nullptr;
    bool same_host = false;
  };

  std::size_t host_index(const std::string& host);
  Way& way(std::size_t from, std::size_t to);
  Topic& topic(const std::string& name, const std::string& robot);
  bool knows(ParticipantId a, ParticipantId b) const;
  void plan_discovery(ParticipantId a, ParticipantId b);
  void discover(ParticipantId a, ParticipantId b);
  void forget(ParticipantId a, ParticipantId b);
  void forget_everywhere(ParticipantId id);
  void tell_watches(const Participant& seen, const Participant& by, bool alive);
  void match(Writer& writer, Reader& reader);
  void match_all(const Participant& a, const Participant& b);
  void unmatch_all(const Participant& writers, const Participant& readers);
  WriterInfo info_of(const Writer& writer, const Participant& by, bool alive) const;

  void write(Writer& writer, std::shared_ptr<const Bytes> cdr);
  void write_now(Writer& writer, std::shared_ptr<const Bytes> cdr);
  void send(Writer& writer, Match& match, Flight flight);
  void launch(Match& match, Flight flight);
  void plan_retry(Writer& writer, Match& match);
  void retry(Writer& writer, const Reader& reader);

  Schedule& schedule_;
  const NetworkOptions options_;
  std::vector<std::string> hosts_;
  std::vector<Duration> clocks_;
  std::map<std::pair<std::size_t, std::size_t>, std::unique_ptr<Way>> ways_;
  std::vector<std::unique_ptr<Participant>> participants_;
  std::map<std::string, std::unique_ptr<Topic>> topics_;
  std::vector<Flight> flights_;
  std::vector<std::uint32_t> free_flights_;
  std::deque<std::function<void(const WrittenSample&)>> observers_;
  Digest digest_;
  std::uint64_t written_ = 0, lost_ = 0;
};

}  // namespace usher::runtime
