#include "control/supervisor/core/drive_right.hpp"

#include <algorithm>

namespace usher::supervisor {

DriveRight::DriveRight(std::string participant, Time slack)
    : participant_(std::move(participant)), slack_(slack) {}

bool DriveRight::knows(const WriterId& writer) const {
  return std::any_of(known_.begin(), known_.end(),
                     [&](const Known& known) { return known.sighting.writer == writer; });
}

void DriveRight::appeared(const WriterSighting& sighting, Time now) {
  if (sighting.writer == drive::kNobody || knows(sighting.writer)) return;
  Role role = Role::kForeign;
  if (sighting.participant == participant_) role = holder() ? Role::kWaiting : Role::kHolder;
  // A full list already holds somebody who must not be there, so one more changes nothing.
  if (known_.size() < kMostWriters) known_.push_back({sighting, now, role});
}

void DriveRight::gone(const WriterId& writer) {
  const auto at = std::find_if(known_.begin(), known_.end(),
                               [&](const Known& known) { return known.sighting.writer == writer; });
  if (at == known_.end()) return;
  const bool was_holder = at->role == Role::kHolder;
  known_.erase(at);
  if (!was_holder) return;
  // A claimer that was unmasked beside the living holder stays foreign: its name was a lie.
  const auto next = std::find_if(known_.begin(), known_.end(),
                                 [](const Known& known) { return known.role == Role::kWaiting; });
  if (next != known_.end()) next->role = Role::kHolder;
}

void DriveRight::alive(const WriterId& writer, Time now) {
  const auto holder = this->holder();
  if (!holder || !drive::same_participant(*holder, writer)) return;
  for (Known& known : known_) {
    if (known.role == Role::kWaiting && now - known.since > slack_) known.role = Role::kForeign;
  }
}

std::optional<WriterId> DriveRight::holder() const {
  for (const Known& known : known_) {
    if (known.role == Role::kHolder) return known.sighting.writer;
  }
  return std::nullopt;
}

const WriterSighting* DriveRight::foreign() const {
  for (const Known& known : known_) {
    if (known.role == Role::kForeign) return &known.sighting;
  }
  return nullptr;
}

}  // namespace usher::supervisor
