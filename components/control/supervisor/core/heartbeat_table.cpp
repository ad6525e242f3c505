#include "control/supervisor/core/heartbeat_table.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace usher::supervisor {

namespace {

/// Two writers of one name are believed to be a restart unless the first speaks again within this.
constexpr Time kConflictMemory = std::chrono::seconds(1);

}  // namespace

HeartbeatTable::HeartbeatTable(std::vector<WatchedComponent> components, std::uint64_t idl_digest)
    : idl_digest_(idl_digest) {
  for (WatchedComponent& component : components) {
    assert(component.timeout > Time::zero());
    assert(find(component.name) == nullptr);
    Record record;
    record.timeout = component.timeout;
    records_.push_back(std::move(record));
    ComponentHealth& entry = health_.emplace_back();
    entry.name = std::move(component.name);
    entry.criticality = component.criticality;
    entry.reason = "never heard";
  }
}

const ComponentHealth* HeartbeatTable::find(std::string_view name) const {
  const auto at = std::find_if(health_.begin(), health_.end(),
                               [name](const ComponentHealth& entry) { return entry.name == name; });
  return at == health_.end() ? nullptr : &*at;
}

Time HeartbeatTable::timeout(std::string_view name) const {
  const ComponentHealth* entry = find(name);
  return entry ? records_[static_cast<std::size_t>(entry - health_.data())].timeout : Time::zero();
}

bool HeartbeatTable::hear(const Heartbeat& heartbeat, Time now) {
  const ComponentHealth* entry = find(heartbeat.component);
  if (!entry) return false;
  const auto index = static_cast<std::size_t>(entry - health_.data());
  Record& record = records_[index];
  ComponentHealth& health = health_[index];
  const Time at = std::max(now, health.heard_at.value_or(now));
  if (heartbeat.writer != record.writer) {
    // A, B, A: both live, and however many more are between. A, B alone is a restart.
    auto& earlier = record.earlier_writers;
    const bool again = std::find(earlier.begin(), earlier.end(), heartbeat.writer) != earlier.end();
    if (again && health.heard_at) {
      record.conflict_at = at;
    } else if (health.heard_at) {
      ++health.restarts;
    }
    earlier[std::exchange(record.next_earlier, (record.next_earlier + 1) % earlier.size())] =
        record.writer;
    record.writer = heartbeat.writer;
  }
  if (now < at) return true;  // an old one unsays nothing
  record.reported = heartbeat.state;
  record.idl_digest = heartbeat.idl_digest;
  record.reason = heartbeat.reason;
  health.longest_handler = heartbeat.longest_handler;
  if (health.host != heartbeat.host) health.host = heartbeat.host;
  health.heard_at = now;
  return true;
}

void HeartbeatTable::set(ComponentHealth& entry, Health health, std::string_view reason) {
  entry.health = health;
  if (entry.reason != reason) entry.reason = reason;
}

void HeartbeatTable::judge(Time now) {
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const Record& record = records_[i];
    ComponentHealth& entry = health_[i];
    if (!entry.heard_at) {
      set(entry, Health::kMissing, "never heard");
    } else if (now - *entry.heard_at >= record.timeout) {
      set(entry, Health::kMissing, "silent");
    } else if (record.idl_digest != idl_digest_) {
      set(entry, Health::kWrongIdl, "built from another IDL than the supervisor");
    } else if (record.conflict_at && now - *record.conflict_at < kConflictMemory) {
      set(entry, Health::kFault, "two live participants have this name");
    } else {
      switch (record.reported) {
        case Reported::kOk:
          set(entry, Health::kOk, "");
          break;
        case Reported::kDegraded:
          set(entry, Health::kDegraded, record.reason);
          break;
        case Reported::kStarting:
          set(entry, Health::kMissing, record.reason.empty() ? "starting" : record.reason);
          break;
        case Reported::kFault:
        default:  // a number that nobody defined is no good news either
          set(entry, Health::kFault, record.reason.empty() ? "failed" : record.reason);
          break;
      }
    }
  }
}

const ComponentHealth* HeartbeatTable::first_lost(Criticality criticality) const {
  for (const ComponentHealth& entry : health_) {
    if (entry.criticality == criticality && !entry.able()) return &entry;
  }
  return nullptr;
}

bool HeartbeatTable::degraded() const {
  return std::any_of(health_.begin(), health_.end(), [](const ComponentHealth& entry) {
    return entry.criticality != Criticality::kNotify && entry.health != Health::kOk;
  });
}

}  // namespace usher::supervisor
