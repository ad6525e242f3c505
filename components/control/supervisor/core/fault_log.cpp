#include "control/supervisor/core/fault_log.hpp"

#include <algorithm>

namespace usher::supervisor {

std::string_view text(Cause cause) {
  switch (cause) {
    case Cause::kComponentLost:
      return "component lost";
    case Cause::kBaseFallsShort:
      return "the base falls short of its command";
    case Cause::kForeignWriter:
      return "foreign writer";
    case Cause::kDisobeyingBase:
      return "the base disobeys";
    case Cause::kEmergencyStop:
      return "emergency stop";
    case Cause::kBaseUnheard:
      return "base unheard";
    case Cause::kNotKept:
      return "a restart would forget";
    case Cause::kMovesWhileStopped:
      return "moves though it is stopped";
  }
  return "unknown cause";
}

void FaultLog::raise(Cause cause, std::string_view component, std::string_view detail, Time now) {
  for (const Fault& fault : faults_) {
    if (fault.active && fault.cause == cause && fault.component == component) return;
  }
  if (faults_.size() >= kCapacity) {
    const auto over = std::find_if(faults_.begin(), faults_.end(),
                                   [](const Fault& fault) { return !fault.active; });
    if (over != faults_.end()) {
      faults_.erase(over);
    } else if (latches(cause)) {
      // So many active ones: give up one that ends by itself, never a latched one.
      const auto loose = std::find_if(faults_.begin(), faults_.end(),
                                      [](const Fault& fault) { return !fault.latched(); });
      if (loose != faults_.end()) {
        faults_.erase(loose);
      } else if (cause == Cause::kEmergencyStop) {
        faults_.pop_back();  // the motors must go off; the rest stays to be cleared with it
      } else {
        return;
      }
    } else {
      return;
    }
  }
  faults_.push_back({next_id_++, now, cause, std::string(component), std::string(detail)});
}

void FaultLog::settle(Cause cause, std::string_view component, Time now) {
  if (latches(cause)) return;
  for (Fault& fault : faults_) {
    if (!fault.active || fault.cause != cause || fault.component != component) continue;
    fault.active = false;
    fault.ended = now;
  }
}

void FaultLog::clear(std::string_view by, Time now) {
  for (Fault& fault : faults_) {
    if (!fault.active || !fault.latched()) continue;
    fault.active = false;
    fault.ended = now;
    fault.ended_by = by;
  }
}

void FaultLog::restore(std::vector<Fault> faults) {
  if (faults.size() > kCapacity) faults.resize(kCapacity);
  for (const Fault& fault : faults) next_id_ = std::max(next_id_, fault.id + 1);
  faults_ = std::move(faults);
}

const Fault* FaultLog::latched() const {
  const auto at = std::find_if(faults_.begin(), faults_.end(),
                               [](const Fault& fault) { return fault.active && fault.latched(); });
  return at == faults_.end() ? nullptr : &*at;
}

bool FaultLog::active(Cause cause) const {
  return std::any_of(faults_.begin(), faults_.end(),
                     [cause](const Fault& fault) { return fault.active && fault.cause == cause; });
}

}  // namespace usher::supervisor
