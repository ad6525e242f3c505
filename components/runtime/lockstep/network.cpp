#include "runtime/lockstep/network.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace usher::runtime {
namespace {

/// A reliable writer's heartbeat period: how soon it repeats what was not acknowledged.
constexpr Duration kRetry = std::chrono::milliseconds(20);
constexpr Duration kShortest = std::chrono::microseconds(1);

}  // namespace

/// One direction between two hosts.
struct Network::Way {
  Link link;
  Random random{0};
  struct Cut {
    Time from, until;
  };
  std::vector<Cut> cuts;

  /// When the way is open again; `now` when it is.
  Time open_from(Time now) const {
    Time open = now;
    for (const Cut& cut : cuts) {
      if (cut.from <= now && now < cut.until) open = std::max(open, cut.until);
    }
    return open;
  }
  bool is_open(Time now) const { return open_from(now) == now; }
  Duration draw_latency() {
    const double part = link.jitter > Duration::zero() ? random.uniform() : 0.0;
    return std::max(link.latency + from_seconds(part * seconds(link.jitter)), kShortest);
  }
  bool draw_loss() { return link.loss > 0.0 && random.uniform() < link.loss; }
};

struct Network::Watch {
  std::string topic;
  std::function<void(const WriterInfo&)> event;
};

struct Network::Participant {
  ParticipantId id = 0;
  std::string name;
  std::size_t host = 0;
  std::string host_name;  ///< as the robot calls it
  std::string robot;
  bool instant = false;
  bool alive = true;
  bool announced = false;
  Time departure{};
  std::vector<std::unique_ptr<Reader>> readers;
  std::vector<std::unique_ptr<Writer>> writers;
  std::vector<Watch> watches;
  std::vector<Time> known_since;  ///< by participant; Time::max() = unknown
};

struct Network::Topic {
  std::string name;
  std::uint64_t digest = 0;
  std::deque<Tamper> tampers;
  std::deque<std::pair<const MessageType*, Observer>> observers;  ///< an observer may add observers
};

class Network::Reader final : public Transport::Reader {
 public:
  Reader(Network& its_network, Participant& its_participant, const InputDeclaration& declaration,
         Transport::Deliver its_deliver)
      : network(its_network),
        participant(its_participant),
        topic(declaration.topic),
        scope(declaration.scope),
        type(declaration.type),
        qos(declaration.qos),
        deliver(std::move(its_deliver)) {}

  std::vector<WriterInfo> writers() const override;

  Network& network;
  Participant& participant;
  std::string topic;
  topics::Scope scope;
  const MessageType* type;
  Qos qos;
  Transport::Deliver deliver;
  std::vector<const Writer*> matched;
};

/// One reader as its writer sees it.
struct Network::Match {
  Reader* reader = nullptr;
  Way* way = nullptr;
  Time last_arrival{};          ///< reliable samples arrive in order
  std::vector<Flight> pending;  ///< reliable samples that did not get through yet
  bool retry_planned = false;
};

class Network::Writer final : public Transport::Writer {
 public:
  Writer(Network& its_network, Participant& its_participant, Topic& its_topic,
         const OutputDeclaration& declaration, const Guid& its_guid)
      : network(its_network),
        participant(its_participant),
        topic(its_topic),
        scope(declaration.scope),
        type(declaration.type),
        qos(declaration.qos),
        id(its_guid) {}

  bool write(std::shared_ptr<const Bytes> cdr) override {
    network.write(*this, std::move(cdr));
    return true;
  }
  std::size_t reader_count() const override { return matches.size(); }
  Guid guid() const override { return id; }

  Network& network;
  Participant& participant;
  Topic& topic;
  topics::Scope scope;
  const MessageType* type;
  Qos qos;
  Guid id;
  std::uint64_t number = 0;
  std::vector<Match> matches;
  std::deque<std::pair<std::uint64_t, std::shared_ptr<const void>>> history;  ///< when latched
};

std::vector<WriterInfo> Network::Reader::writers() const {
  std::vector<WriterInfo> infos;
  for (const Writer* writer : matched) {
    infos.push_back(network.info_of(*writer, participant, true));
  }
  return infos;
}

Network::Network(Schedule& schedule, NetworkOptions options)
    : schedule_(schedule), options_(options) {}
Network::~Network() = default;

// --- Hosts and links
// ------------------------------------------------------------------------------------------------

std::size_t Network::host_index(const std::string& host) {
  const auto found = std::find(hosts_.begin(), hosts_.end(), host);
  if (found != hosts_.end()) return static_cast<std::size_t>(found - hosts_.begin());
  hosts_.push_back(host);
  clocks_.emplace_back();
  return hosts_.size() - 1;
}

Network::Way& Network::way(std::size_t from, std::size_t to) {
  auto& entry = ways_[{from, to}];
  if (!entry) {
    entry = std::make_unique<Way>();
    entry->link = from == to ? options_.inside_host : options_.between_hosts;
    const std::string name = hosts_[from] + " -> " + hosts_[to];
    entry->random = Random(stream_seed(options_.seed, name.c_str()));
  }
  return *entry;
}

void Network::set_clock(const std::string& host, Duration ahead) {
  clocks_[host_index(host)] = ahead;
}

Duration Network::clock_of(ParticipantId id) const { return clocks_[participants_[id]->host]; }

void Network::set_link(const std::string& a, const std::string& b, const Link& link) {
  const std::size_t from = host_index(a), to = host_index(b);
  way(from, to).link = link;
  way(to, from).link = link;
}

void Network::jump_clock(const std::string& host, Duration by) {
  assert(by >= Duration::zero());
  clocks_[host_index(host)] += by;
}

void Network::cut(const std::string& a, const std::string& b, Time from, Time until, bool one_way) {
  const std::size_t first = host_index(a), second = host_index(b);
  assert(first != second && from < until);
  way(first, second).cuts.push_back({from, until});
  if (!one_way) way(second, first).cuts.push_back({from, until});
  const auto for_pairs = [this, first,
                          second](void (Network::*action)(ParticipantId, ParticipantId)) {
    for (ParticipantId p = 0; p < participants_.size(); ++p) {
      for (ParticipantId q = 0; q < participants_.size(); ++q) {
        if (participants_[p]->host == first && participants_[q]->host == second)
          (this->*action)(p, q);
      }
    }
  };
  if (until - from > options_.lease) {
    schedule_.add_action(from + options_.lease, [for_pairs] { for_pairs(&Network::forget); });
  }
  schedule_.add_action(until, [for_pairs] { for_pairs(&Network::plan_discovery); });
}

// --- Participants
// ----------------------------------------------------------------------------------------------------

Network::ParticipantId Network::join(const std::string& name, const std::string& host, bool instant,
                                     const std::string& robot) {
  auto participant = std::make_unique<Participant>();
  participant->id = static_cast<ParticipantId>(participants_.size());
  participant->name = name;
  participant->host = host_index(robot.empty() ? host : robot + "/" + host);
  participant->host_name = host;
  participant->instant = instant;
  participant->robot = robot;
  participants_.push_back(std::move(participant));
  for (const auto& each : participants_)
    each->known_since.resize(participants_.size(), Time::max());
  return static_cast<ParticipantId>(participants_.size() - 1);
}

void Network::announce(ParticipantId id) {
  participants_[id]->announced = true;
  for (ParticipantId other = 0; other < participants_.size(); ++other) {
    if (other != id) plan_discovery(id, other);
  }
}

void Network::leave(ParticipantId id) {
  Participant& gone = *participants_[id];
  if (!gone.alive) return;
  gone.alive = false;
  for (ParticipantId other = 0; other < participants_.size(); ++other) {
    if (!knows(id, other)) continue;
    const Way& between = way(gone.host, participants_[other]->host);
    // Behind a cut link the farewell is lost: there the lease decides.
    const Duration delay = between.is_open(schedule_.now())
                               ? std::max(between.link.latency, kShortest)
                               : options_.lease;
    schedule_.add_action(schedule_.now() + delay, [this, id, other] { forget(id, other); });
  }
}

void Network::vanish(ParticipantId id) {
  Participant& gone = *participants_[id];
  if (!gone.alive) return;
  gone.alive = false;
  schedule_.add_action(schedule_.now() + options_.lease, [this, id] { forget_everywhere(id); });
}

bool Network::present(ParticipantId id) const { return participants_[id]->alive; }

void Network::forget_everywhere(ParticipantId id) {
  for (ParticipantId other = 0; other < participants_.size(); ++other) forget(id, other);
}

const std::string& Network::participant_of(const Guid& writer) const {
  static const std::string kNobody;
  for (const auto& participant : participants_) {
    for (const auto& each : participant->writers) {
      if (each->id == writer) return participant->name;
    }
  }
  return kNobody;
}

bool Network::knows(ParticipantId a, ParticipantId b) const {
  return participants_[a]->known_since[b] != Time::max();
}

void Network::plan_discovery(ParticipantId a, ParticipantId b) {
  if (knows(a, b)) return;
  if (participants_[a]->instant || participants_[b]->instant) {
    discover(a, b);
  } else {
    schedule_.add_action(schedule_.now() + options_.discovery, [this, a, b] { discover(a, b); });
  }
}

void Network::discover(ParticipantId a, ParticipantId b) {
  Participant &first = *participants_[a], &second = *participants_[b];
  const auto ready = [](const Participant& p) { return p.alive && p.announced; };
  if (knows(a, b) || !ready(first) || !ready(second)) return;
  if (!way(first.host, second.host).is_open(schedule_.now())) return;  // again when the cut ends
  first.known_since[b] = second.known_since[a] = schedule_.now();
  tell_watches(first, second, true);
  tell_watches(second, first, true);
  match_all(first, second);
  match_all(second, first);
}

void Network::forget(ParticipantId a, ParticipantId b) {
  if (!knows(a, b)) return;
  Participant &first = *participants_[a], &second = *participants_[b];
  tell_watches(first, second, false);
  tell_watches(second, first, false);
  first.known_since[b] = second.known_since[a] = Time::max();
  unmatch_all(first, second);
  unmatch_all(second, first);
}

void Network::tell_watches(const Participant& seen, const Participant& by, bool alive) {
  if (!by.alive) return;
  for (const Watch& watch : by.watches) {
    for (const auto& writer : seen.writers) {
      if (writer->topic.name == watch.topic && seen.robot == by.robot)
        watch.event(info_of(*writer, by, alive));
    }
  }
}

WriterInfo Network::info_of(const Writer& writer, const Participant& by, bool alive) const {
  const Participant& owner = writer.participant;
  const Time since = by.id == owner.id ? Time{} : by.known_since[owner.id] + clocks_[by.host];
  return {writer.id, writer.topic.name, owner.name, owner.host_name, alive, since};
}

// --- Endpoints
// -------------------------------------------------------------------------------------------------------

Network::Topic& Network::topic(const std::string& name, const std::string& robot) {
  const std::string key = robot.empty() ? name : robot + ' ' + name;
  auto& entry = topics_[key];
  if (!entry) {
    entry = std::make_unique<Topic>();
    entry->name = name;
    entry->digest = stream_seed(0, key.c_str());
  }
  return *entry;
}

Transport::Reader& Network::open_reader(ParticipantId id, const InputDeclaration& declaration,
                                        Transport::Deliver deliver) {
  Participant& own = *participants_[id];
  own.readers.push_back(std::make_unique<Reader>(*this, own, declaration, std::move(deliver)));
  Reader& reader = *own.readers.back();
  for (const auto& other : participants_) {
    if (other->id != id && !knows(id, other->id)) continue;
    for (const auto& writer : other->writers) match(*writer, reader);
  }
  return reader;
}

Transport::Writer& Network::open_writer(ParticipantId id, const OutputDeclaration& declaration) {
  Participant& own = *participants_[id];
  Guid guid{0x01, 0x0f, 'l', 'o', 'c', 'k'};
  const auto entity = static_cast<std::uint32_t>(own.writers.size() + 1);
  for (std::size_t i = 0; i < 4; ++i) {
    guid[11 - i] = static_cast<std::uint8_t>((id + 1) >> (8 * i));
    guid[15 - i] = static_cast<std::uint8_t>(entity >> (8 * i));
  }
  const bool of_fleet = declaration.scope == topics::Scope::kFleet;
  Topic& its_topic = topic(declaration.topic, of_fleet ? std::string() : own.robot);
  own.writers.push_back(std::make_unique<Writer>(*this, own, its_topic, declaration, guid));
  Writer& writer = *own.writers.back();
  for (const auto& other : participants_) {
    if (other->id != id && !knows(id, other->id)) continue;
    if (other->id != id) {
      for (const Watch& watch : other->watches) {
        if (watch.topic == its_topic.name && other->robot == own.robot)
          watch.event(info_of(writer, *other, true));
      }
    }
    for (const auto& reader : other->readers) match(writer, *reader);
  }
  return writer;
}

void Network::watch_writers(ParticipantId id, const std::string& topic_name,
                            std::function<void(const WriterInfo&)> event) {
  Participant& own = *participants_[id];
  own.watches.push_back({topic_name, std::move(event)});
  for (const auto& other : participants_) {
    if (other->id == id || !knows(id, other->id)) continue;
    for (const auto& writer : other->writers) {
      if (writer->topic.name == topic_name && other->robot == own.robot)
        own.watches.back().event(info_of(*writer, own, true));
    }
  }
}

void Network::set_departure(ParticipantId id, Time departure) {
  participants_[id]->departure = departure;
}

void Network::match(Writer& writer, Reader& reader) {
  const bool common =
      writer.scope == topics::Scope::kFleet || writer.participant.robot == reader.participant.robot;
  const bool fits = common && writer.scope == reader.scope && writer.topic.name == reader.topic &&
                    writer.type == reader.type && (writer.qos.reliable || !reader.qos.reliable) &&
                    (writer.qos.latched || !reader.qos.latched);
  if (!fits) return;
  Match fresh;
  fresh.reader = &reader;
  fresh.way = &way(writer.participant.host, reader.participant.host);
  writer.matches.push_back(std::move(fresh));
  reader.matched.push_back(&writer);
  if (!reader.qos.latched) return;
  const bool same_host = writer.participant.host == reader.participant.host;
  for (const auto& [number, message] : writer.history) {
    send(writer, writer.matches.back(), {message, writer.id, number, &reader, same_host});
  }
}

void Network::match_all(const Participant& a, const Participant& b) {
  for (const auto& writer : a.writers) {
    for (const auto& reader : b.readers) match(*writer, *reader);
  }
}

void Network::unmatch_all(const Participant& writers, const Participant& readers) {
  for (const auto& writer : writers.writers) {
    std::erase_if(writer->matches,
                  [&](const Match& each) { return &each.reader->participant == &readers; });
  }
  for (const auto& reader : readers.readers) {
    std::erase_if(reader->matched,
                  [&](const Writer* each) { return &each->participant == &writers; });
  }
}

// --- Samples
// ----------------------------------------------------------------------------------------------------------

void Network::write(Writer& writer, std::shared_ptr<const Bytes> cdr) {
  const Participant& own = writer.participant;
  if (own.departure <= schedule_.now()) {
    write_now(writer, std::move(cdr));
  } else {
    schedule_.add_action(own.departure,
                         [this, &writer, cdr = std::move(cdr)] { write_now(writer, cdr); });
  }
}

void Network::tamper(const std::string& topic_name, Tamper tamper, const std::string& robot) {
  topic(topic_name, robot).tampers.push_back(std::move(tamper));
}

void Network::write_now(Writer& writer, std::shared_ptr<const Bytes> cdr) {
  if (!writer.participant.alive) return;
  const Time now = schedule_.now();
  Topic& own_topic = writer.topic;
  if (!own_topic.tampers.empty()) {
    Bytes bytes = *cdr;
    for (const Tamper& each : own_topic.tampers) {
      if (!each(writer.id, bytes)) return;
    }
    cdr = std::make_shared<const Bytes>(std::move(bytes));
  }
  ++written_;
  const std::uint64_t number = ++writer.number;
  digest_.add(own_topic.digest ^ writer.participant.id);
  digest_.add(static_cast<std::uint64_t>(now.time_since_epoch().count()));
  digest_.add(std::span<const std::uint8_t>(*cdr));

  std::shared_ptr<const void> message;
  if (!writer.matches.empty() || !own_topic.observers.empty() || writer.qos.latched) {
    message = writer.type->deserialize(*cdr);
  }
  for (std::size_t i = 0; i < writer.matches.size(); ++i) {
    Match& each = writer.matches[i];
    const bool same_host = writer.participant.host == each.reader->participant.host;
    send(writer, each, {message, writer.id, number, each.reader, same_host});
  }
  if (writer.qos.latched) {
    if (writer.history.size() == static_cast<std::size_t>(writer.qos.depth))
      writer.history.pop_front();
    writer.history.emplace_back(number, message);
  }
  // Observers last and by index: they may publish, which may add to the lists.
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    observers_[i](
        {own_topic.name, writer.participant.robot, *writer.type, writer.id, number, now, *cdr});
  }
  for (std::size_t i = 0; i < own_topic.observers.size(); ++i) {
    if (own_topic.observers[i].first != writer.type || !message) continue;
    own_topic.observers[i].second(message, {writer.id, now, number, true, now});
  }
}

void Network::send(Writer& writer, Match& match, Flight flight) {
  if (!match.reader->participant.alive) return;
  const bool passes = match.way->is_open(schedule_.now()) && !match.way->draw_loss();
  if (passes && match.pending.empty()) {
    launch(match, std::move(flight));
  } else if (match.reader->qos.reliable) {
    if (match.pending.size() == static_cast<std::size_t>(writer.qos.depth)) {
      match.pending.erase(match.pending.begin());
      ++lost_;
    }
    match.pending.push_back(std::move(flight));
    plan_retry(writer, match);
  } else {
    ++lost_;
  }
}

void Network::launch(Match& match, Flight flight) {
  Time arrival = schedule_.now() + match.way->draw_latency();
  if (match.reader->qos.reliable) arrival = std::max(arrival, match.last_arrival);
  match.last_arrival = arrival;
  std::uint32_t index = 0;
  if (free_flights_.empty()) {
    index = static_cast<std::uint32_t>(flights_.size());
    flights_.push_back(std::move(flight));
  } else {
    index = free_flights_.back();
    free_flights_.pop_back();
    flights_[index] = std::move(flight);
  }
  schedule_.add_delivery(arrival, index);
}

void Network::deliver(std::uint32_t index) {
  Flight flight = std::move(flights_[index]);
  free_flights_.push_back(index);
  const Reader& reader = *flight.reader;
  if (!reader.participant.alive) return;
  reader.deliver(std::move(flight.message), flight.writer, flight.number, flight.same_host);
}

void Network::plan_retry(Writer& writer, Match& match) {
  if (match.retry_planned) return;
  match.retry_planned = true;
  const Time at = match.way->open_from(schedule_.now()) + kRetry;
  schedule_.add_action(at, [this, &writer, reader = match.reader] { retry(writer, *reader); });
}

void Network::retry(Writer& writer, const Reader& reader) {
  const auto found = std::find_if(writer.matches.begin(), writer.matches.end(),
                                  [&](const Match& each) { return each.reader == &reader; });
  if (found == writer.matches.end() || !found->retry_planned) return;
  found->retry_planned = false;
  if (!writer.participant.alive) return;
  if (!found->way->is_open(schedule_.now()) || found->way->draw_loss()) {
    plan_retry(writer, *found);
    return;
  }
  for (Flight& flight : found->pending) launch(*found, std::move(flight));
  found->pending.clear();
}

// --- Observation
// ------------------------------------------------------------------------------------------------------

void Network::observe(const std::string& topic_name, const MessageType& type, Observer observer,
                      const std::string& robot) {
  topic(topic_name, robot).observers.emplace_back(&type, std::move(observer));
}

void Network::observe_all(std::function<void(const WrittenSample&)> observer) {
  observers_.push_back(std::move(observer));
}

}  // namespace usher::runtime
