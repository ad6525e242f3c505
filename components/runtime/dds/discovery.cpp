#include "runtime/dds/discovery.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

namespace usher::runtime {

std::string Identity::user_data() const {
  std::array<char, 17> digest{};
  std::snprintf(digest.data(), digest.size(), "%016llx",
                static_cast<unsigned long long>(idl_digest));
  return "usher;name=" + name + ";host=" + host + ";idl=" + digest.data();
}

std::optional<Identity> Identity::parse(std::string_view user_data) {
  constexpr std::string_view kMark = "usher;";
  if (!user_data.starts_with(kMark)) return std::nullopt;
  Identity identity;
  for (std::string_view rest = user_data.substr(kMark.size()); !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view entry = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (entry.starts_with("name=")) identity.name = entry.substr(5);
    if (entry.starts_with("host=")) identity.host = entry.substr(5);
    if (entry.starts_with("idl=")) {
      std::from_chars(entry.data() + 4, entry.data() + entry.size(), identity.idl_digest, 16);
    }
  }
  return identity;
}

std::string to_string(const Refusal& refusal) {
  const std::string from =
      refusal.address.empty() ? " from an unknown address" : " from " + refusal.address;
  if (!refusal.name.empty())
    return "refused: participant '" + refusal.name + "'" + from + " has no identity of this robot";
  return "refused: " + std::to_string(refusal.messages) + " messages" + from +
         " that are malformed or not signed by this robot";
}

DiscoveryBook::DiscoveryBook(std::string host, std::function<Time()> clock)
    : host_(std::move(host)), clock_(std::move(clock)) {}

DiscoveryBook::Prefix DiscoveryBook::prefix_of(const Guid& guid) {
  Prefix prefix;
  std::copy_n(guid.begin(), prefix.size(), prefix.begin());
  return prefix;
}

void DiscoveryBook::participant_seen(const Guid& guid, const Identity& identity,
                                     std::string address) {
  const std::scoped_lock event_lock(event_mutex_);
  ParticipantInfo info{guid, identity, std::move(address), clock_()};
  std::vector<EndpointInfo> known;
  {
    const std::scoped_lock lock(mutex_);
    if (!participants_.emplace(prefix_of(guid), info).second) return;
    const auto waits = [&](const EndpointInfo& endpoint) {
      return prefix_of(endpoint.guid) == prefix_of(guid);
    };
    for (EndpointInfo& endpoint : nameless_) {
      if (!waits(endpoint)) continue;
      endpoint.participant = identity.name;
      endpoint.host = identity.host;
      if (endpoints_.emplace(endpoint.guid, endpoint).second) known.push_back(endpoint);
    }
    std::erase_if(nameless_, waits);
  }
  for (const auto& event : participant_events_) event(info, true);
  for (const EndpointInfo& endpoint : known) notify(endpoint, true);
}

void DiscoveryBook::participant_gone(const Guid& guid) {
  const std::scoped_lock event_lock(event_mutex_);
  std::vector<EndpointInfo> lost;
  std::optional<ParticipantInfo> info;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = participants_.find(prefix_of(guid));
    if (found != participants_.end()) {
      info = std::move(found->second);
      participants_.erase(found);
    }
    std::erase_if(nameless_, [&](const EndpointInfo& endpoint) {
      return prefix_of(endpoint.guid) == prefix_of(guid);
    });
    std::erase_if(endpoints_, [&](const auto& entry) {
      if (prefix_of(entry.first) != prefix_of(guid)) return false;
      lost.push_back(entry.second);
      return true;
    });
  }
  for (const EndpointInfo& endpoint : lost) notify(endpoint, false);
  if (!info) return;
  for (const auto& event : participant_events_) event(*info, false);
}

void DiscoveryBook::endpoint_seen(EndpointInfo endpoint) {
  const std::scoped_lock event_lock(event_mutex_);
  endpoint.since = clock_();
  {
    const std::scoped_lock lock(mutex_);
    const auto owner = participants_.find(prefix_of(endpoint.guid));
    if (owner == participants_.end()) {
      // Told by another thread than its participant is, and first: without a name it would look
      // foreign to whoever watches the writers.
      std::erase_if(nameless_, [&](const auto& other) { return other.guid == endpoint.guid; });
      if (nameless_.size() < kMaxNameless) nameless_.push_back(std::move(endpoint));
      return;
    }
    endpoint.participant = owner->second.identity.name;
    endpoint.host = owner->second.identity.host;
    if (!endpoints_.emplace(endpoint.guid, endpoint).second) return;
  }
  notify(endpoint, true);
}

void DiscoveryBook::endpoint_gone(const Guid& guid) {
  const std::scoped_lock event_lock(event_mutex_);
  EndpointInfo endpoint;
  {
    const std::scoped_lock lock(mutex_);
    std::erase_if(nameless_, [&](const auto& other) { return other.guid == guid; });
    const auto found = endpoints_.find(guid);
    if (found == endpoints_.end()) return;
    endpoint = std::move(found->second);
    endpoints_.erase(found);
  }
  notify(endpoint, false);
}

void DiscoveryBook::participant_refused(const Guid& guid) {
  {
    const std::scoped_lock lock(mutex_);
    const auto found = participants_.find(prefix_of(guid));
    if (found == participants_.end()) return;  // told before, or it has left
    refusal(found->second.identity.name, found->second.address);
  }
  participant_gone(guid);
}

void DiscoveryBook::message_refused(const std::string& address) {
  const std::scoped_lock lock(mutex_);
  ++refusal({}, address).messages;
}

/// Under mutex_.
Refusal& DiscoveryBook::refusal(const std::string& name, const std::string& address) {
  const auto found = std::ranges::find_if(refusals_, [&](const Refusal& known) {
    return known.name == name && known.address == address;
  });
  if (found != refusals_.end()) return *found;
  if (refusals_.size() == kMaxRefusals) return refusals_.back();
  return refusals_.emplace_back(Refusal{name, address, 0, clock_()});
}

std::vector<Refusal> DiscoveryBook::refusals() const {
  const std::scoped_lock lock(mutex_);
  return refusals_;
}

void DiscoveryBook::notify(const EndpointInfo& endpoint, bool alive) const {
  for (const auto& event : endpoint_events_) event(endpoint, alive);
}

void DiscoveryBook::observe(ParticipantEvent participant, EndpointEvent endpoint) {
  const std::scoped_lock event_lock(event_mutex_);
  if (participant) {
    for (const ParticipantInfo& info : participants()) participant(info, true);
    participant_events_.push_back(std::move(participant));
  }
  if (endpoint) {
    for (const EndpointInfo& info : endpoints()) endpoint(info, true);
    endpoint_events_.push_back(std::move(endpoint));
  }
}

std::vector<ParticipantInfo> DiscoveryBook::participants() const {
  const std::scoped_lock lock(mutex_);
  std::vector<ParticipantInfo> result;
  for (const auto& [prefix, info] : participants_) result.push_back(info);
  return result;
}

std::vector<EndpointInfo> DiscoveryBook::endpoints() const {
  const std::scoped_lock lock(mutex_);
  std::vector<EndpointInfo> result;
  for (const auto& [guid, info] : endpoints_) result.push_back(info);
  return result;
}

WriterInfo DiscoveryBook::writer(const Guid& guid) const {
  const std::scoped_lock lock(mutex_);
  const auto found = endpoints_.find(guid);
  if (found == endpoints_.end())
    return {.guid = guid, .topic = {}, .participant = {}, .host = {}, .alive = true};
  const EndpointInfo& info = found->second;
  return {guid, info.topic, info.participant, info.host, true, info.since};
}

bool DiscoveryBook::same_host(const Guid& writer, const Guid& own) const {
  const std::scoped_lock lock(mutex_);
  const auto found = participants_.find(prefix_of(writer));
  if (found != participants_.end() && !found->second.identity.host.empty()) {
    return found->second.identity.host == host_;
  }
  return std::equal(writer.begin(), writer.begin() + 4, own.begin());
}

}  // namespace usher::runtime
