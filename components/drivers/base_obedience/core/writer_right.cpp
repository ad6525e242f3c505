#include "drivers/base_obedience/core/writer_right.hpp"

#include <algorithm>

namespace usher::drive {

std::vector<std::string> allowed_writers(std::string_view types,
                                         const std::vector<NamedComponent>& manifest) {
  constexpr std::string_view kOperator = "operator";
  constexpr std::string_view kSimulated = "_sim";
  std::vector<std::string> names;
  while (!types.empty()) {
    const std::size_t end = std::min(types.find(' '), types.size());
    const std::string_view type = types.substr(0, end);
    types.remove_prefix(std::min(end + 1, types.size()));
    if (type == kOperator) names.emplace_back(kOperator);
    for (const NamedComponent& component : manifest) {
      std::string_view role = component.type;
      if (role.ends_with(kSimulated)) role.remove_suffix(kSimulated.size());
      if (role == type) names.push_back(component.name);
    }
  }
  return names;
}

WriterRight::WriterRight(std::vector<std::string> participants, Time slack)
    : participants_(std::move(participants)), slack_(slack) {}

bool WriterRight::allows(const std::string& participant) const {
  return std::find(participants_.begin(), participants_.end(), participant) != participants_.end();
}

const WriterRight::Known* WriterRight::holder_of(const std::string& participant) const {
  const auto at = std::find_if(known_.begin(), known_.end(), [&](const Known& known) {
    return known.role == Role::kHolder && known.sighting.participant == participant;
  });
  return at == known_.end() ? nullptr : &*at;
}

void WriterRight::appeared(const WriterSighting& sighting, Time now) {
  const bool listed = std::any_of(known_.begin(), known_.end(), [&](const Known& known) {
    return known.sighting.writer == sighting.writer;
  });
  if (sighting.writer == kNobody || listed) return;
  Role role = Role::kForeign;
  if (allows(sighting.participant)) {
    role = holder_of(sighting.participant) != nullptr ? Role::kWaiting : Role::kHolder;
  }
  if (known_.size() == kMostWriters) {
    // Of those who must not be there one more is counted only; who may be there has a place.
    const auto foreign = std::find_if(known_.rbegin(), known_.rend(), [](const Known& known) {
      return known.role == Role::kForeign;
    });
    ++unlisted_;
    if (role == Role::kForeign || foreign == known_.rend()) return;
    known_.erase(std::next(foreign).base());
  }
  known_.push_back({sighting, now, role});
}

void WriterRight::gone(const WriterId& writer) {
  const auto at = std::find_if(known_.begin(), known_.end(),
                               [&](const Known& known) { return known.sighting.writer == writer; });
  if (at == known_.end()) {
    if (unlisted_ > 0) --unlisted_;
    return;
  }
  const bool was_holder = at->role == Role::kHolder;
  const std::string name = std::move(at->sighting.participant);
  known_.erase(at);
  if (!was_holder) return;
  // A claimer that was unmasked beside the living holder stays foreign: its name was a lie.
  const auto next = std::find_if(known_.begin(), known_.end(), [&](const Known& known) {
    return known.role == Role::kWaiting && known.sighting.participant == name;
  });
  if (next != known_.end()) next->role = Role::kHolder;
}

void WriterRight::alive(const WriterId& writer, Time now) {
  const auto speaks = std::find_if(known_.begin(), known_.end(), [&](const Known& known) {
    return known.role == Role::kHolder && same_participant(known.sighting.writer, writer);
  });
  if (speaks == known_.end()) return;
  speaks->heard_at = now;
  for (Known& known : known_) {
    const bool claims =
        known.role == Role::kWaiting && known.sighting.participant == speaks->sighting.participant;
    if (claims && now - known.since > slack_) known.role = Role::kForeign;
  }
}

bool WriterRight::holds(const WriterId& writer) const {
  return std::any_of(known_.begin(), known_.end(), [&](const Known& known) {
    return known.role == Role::kHolder && known.sighting.writer == writer;
  });
}

bool WriterRight::trusted(const WriterId& writer) const {
  const auto at = std::find_if(known_.begin(), known_.end(),
                               [&](const Known& known) { return known.sighting.writer == writer; });
  if (at == known_.end()) return false;
  return std::none_of(known_.begin(), known_.end(), [&](const Known& known) {
    return known.role == Role::kForeign && known.sighting.participant == at->sighting.participant;
  });
}

bool WriterRight::doubted(Time now, Time silence) const {
  const auto holder = std::ranges::find(known_, Role::kHolder, &Known::role);
  if (holder == known_.end()) return false;
  const bool silent = !holder->heard_at || now - *holder->heard_at >= silence;
  return silent && std::ranges::any_of(known_, [&](const Known& known) {
           return known.role == Role::kWaiting &&
                  known.sighting.participant == holder->sighting.participant;
         });
}

std::optional<WriterId> WriterRight::holder() const {
  for (const Known& known : known_) {
    if (known.role == Role::kHolder) return known.sighting.writer;
  }
  return std::nullopt;
}

const WriterSighting* WriterRight::foreign() const {
  for (const Known& known : known_) {
    if (known.role == Role::kForeign) return &known.sighting;
  }
  static const WriterSighting kMore{kNobody, "more than can be listed", ""};
  return unlisted_ > 0 ? &kMore : nullptr;
}

}  // namespace usher::drive
