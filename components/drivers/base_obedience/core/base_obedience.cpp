#include "drivers/base_obedience/core/base_obedience.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::drive {

std::string_view text(Reason reason) {
  switch (reason) {
    case Reason::kObeyed:
      return "the granted command is driven";
    case Reason::kNoGrant:
      return "nobody holds the right to drive";
    case Reason::kGrantExpired:
      return "the grant expired: the supervisor is silent";
    case Reason::kTwoGrantors:
      return "two writers grant the right to drive";
    case Reason::kNoCommand:
      return "no command under the present grant yet";
    case Reason::kCommandExpired:
      return "the command expired: the granted writer is silent";
    case Reason::kForeignWriter:
      return "a writer without the grant commands";
    case Reason::kWrongEpoch:
      return "a command for another epoch than the grant's";
    case Reason::kSequenceNotGrowing:
      return "a command whose sequence does not grow";
    case Reason::kNotFinite:
      return "a command with a value that is not finite";
    case Reason::kBeyondLimits:
      return "a command beyond the base's absolute limits";
  }
  return "unknown reason";
}

BaseObedience::BaseObedience() : BaseObedience(Limits{}) {}

BaseObedience::BaseObedience(const Limits& limits) : limits_(limits) {
  assert(limits.linear > 0.0 && limits.angular > 0.0);
  assert(limits.grant_expiry > Time::zero() && limits.command_expiry > Time::zero());
}

void BaseObedience::grant(const Grant& grant, Time now) {
  const bool grantor_lives = grantor_at_ && now - *grantor_at_ < limits_.grant_expiry;
  if (grantor_lives && grant.grantor != grantor_) {
    // Which of the two is the supervisor cannot be known here: nobody drives until one is silent.
    dispute_at_ = now;
    granted_at_.reset();
    command_.reset();
    return;
  }
  if (grant.epoch > highest_epoch_ && grant.epoch - highest_epoch_ > kLongestLeap) return;
  grantor_ = grant.grantor;
  grantor_at_ = now;
  if (grant.epoch < highest_epoch_) return;

  const bool new_epoch = grant.epoch > highest_epoch_;
  if (!new_epoch && (withdrawn_ || (grant.writer != kNobody && grant.writer != holder_))) {
    // One epoch has one holder: a contradiction ends it.
    withdrawn_ = true;
  } else if (new_epoch) {
    highest_epoch_ = grant.epoch;
    withdrawn_ = false;
    command_.reset();
    if (grant.writer != holder_) sequence_known_ = false;
    holder_ = grant.writer;
  }
  if (grant.writer == kNobody) withdrawn_ = true;
  if (withdrawn_) {
    granted_at_.reset();
    command_.reset();
  } else {
    granted_at_ = now - grant.age;
    grant_life_ = std::min(limits_.grant_expiry, grant.valid_for);
  }
}

bool BaseObedience::of_grantor(const WriterId& writer, Time now) const {
  return grantor_at_ && now - *grantor_at_ < limits_.grant_expiry &&
         same_participant(writer, grantor_);
}

Reason BaseObedience::grant_state(Time now) const {
  if (dispute_at_ && now - *dispute_at_ < limits_.grant_expiry) return Reason::kTwoGrantors;
  if (!granted_at_) return Reason::kNoGrant;
  if (now - *granted_at_ >= grant_life_) return Reason::kGrantExpired;
  return Reason::kObeyed;
}

Reason BaseObedience::judge(const Command& command, Time now) const {
  const Reason state = grant_state(now);
  if (state != Reason::kObeyed) return state;
  if (command.writer != holder_) return Reason::kForeignWriter;
  if (command.epoch != highest_epoch_) return Reason::kWrongEpoch;
  if (sequence_known_ && command.sequence <= last_sequence_) return Reason::kSequenceNotGrowing;
  if (!command.twist.finite()) return Reason::kNotFinite;
  if (std::abs(command.twist.v) > limits_.linear || std::abs(command.twist.w) > limits_.angular) {
    return Reason::kBeyondLimits;
  }
  return Reason::kObeyed;
}

Decision BaseObedience::permitted(const Command& command, Time now) {
  const Reason verdict = judge(command, now);
  ++counts_[static_cast<std::size_t>(verdict)];
  if (command.writer == holder_ && holder_ != kNobody) {
    // Sequences are followed even without a grant, so that nothing old is ever driven later.
    if (!sequence_known_ || command.sequence > last_sequence_) last_sequence_ = command.sequence;
    sequence_known_ = true;
    if (verdict == Reason::kObeyed) {
      command_ = Heard{now - command.age, command.twist};
    } else {
      command_.reset();
    }
  }
  return {permitted(now).twist, verdict};
}

Decision BaseObedience::permitted(Time now) const {
  const Reason state = grant_state(now);
  if (state != Reason::kObeyed) return {{}, state};
  if (!command_) return {{}, Reason::kNoCommand};
  if (now - command_->at >= limits_.command_expiry) return {{}, Reason::kCommandExpired};
  return {command_->twist, Reason::kObeyed};
}

}  // namespace usher::drive
