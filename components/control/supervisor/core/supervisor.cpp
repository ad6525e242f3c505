#include "control/supervisor/core/supervisor.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "foundation/kinematics/roll_out.hpp"

namespace usher::supervisor {

namespace {

/// Higher epochs are not believed: no robot makes so many decisions, and the next one must fit.
constexpr std::uint64_t kHighestEpoch = std::uint64_t{1} << 62;

/// A crash may have lost the last epochs that were granted; a restart begins safely above them.
constexpr std::uint64_t kUnsavedEpochs = 1024;
/// A base that has just started hears no epoch above kLongestLeap: one that is remembered must
/// leave room below. What a base that ran on has heard, it tells.
constexpr std::uint64_t kHighestRemembered = drive::kLongestLeap / 2;
/// So long the answer to an operator stays in the status; others ask again until they are answered.
constexpr Time kOperatorsFirst = std::chrono::milliseconds(100);
constexpr const char* kItself = "supervisor";
constexpr const char* kOthers = "others";  // more clients than are remembered

/// High, to see faces, while somebody stands before the robot; low where it drives.
double camera_angle_in(State state, const Parameters& parameters) {
  switch (state) {
    case State::kInteraction:
    case State::kNavigationStart:
    case State::kNavigationEnd:
      return parameters.camera_angle_interaction;
    case State::kNavigationActive:
    case State::kManual:
      return parameters.camera_angle_navigation;
    default:
      return parameters.camera_angle_default;
  }
}

bool over(GoalState state) {
  return state == GoalState::kSucceeded || state == GoalState::kFailed ||
         state == GoalState::kCancelled;
}

}  // namespace

Supervisor::Supervisor(const Parameters& parameters, Memory memory)
    : parameters_(parameters),
      table_(parameters.components, parameters.idl_digest),
      behavior_(parameters.dwell),
      watch_(parameters.response),
      epoch_(std::min(memory.epoch, kHighestRemembered) + (memory.epoch > 0 ? kUnsavedEpochs : 0)) {
  assert(parameters.degraded_speed_factor >= 0.0 && parameters.degraded_speed_factor <= 1.0);
  assert(!parameters.topics.empty());
  for (const WatchedTopic& topic : parameters.topics) {
    watched_.push_back(
        {topic.name, topic.moves, drive::WriterRight(topic.participants, parameters.claim_slack)});
  }
  stopped_by_ = std::move(memory.stopped_by);
  if (!parameters.movement_on_at_start) stop("start");
  behavior_.manual(memory.manual);
  faults_.restore(std::move(memory.latched));
  decision_.grant.epoch = epoch_;
}

void Supervisor::heartbeat(const Heartbeat& heartbeat, Time now) {
  if (!table_.hear(heartbeat, now)) ++unknown_heartbeats_;
  alive(heartbeat.writer, now);
}

void Supervisor::alive(const WriterId& writer, Time now) {
  for (Watched& watched : watched_) watched.right.alive(writer, now);
}

Supervisor::Watched* Supervisor::watched(std::string_view topic) {
  const auto at = std::find_if(watched_.begin(), watched_.end(),
                               [topic](const Watched& watched) { return watched.topic == topic; });
  return at == watched_.end() ? nullptr : &*at;
}

const Supervisor::Watched* Supervisor::invaded() const {
  const auto at = std::find_if(watched_.begin(), watched_.end(), [](const Watched& watched) {
    return watched.right.foreign() != nullptr;
  });
  return at == watched_.end() ? nullptr : &*at;
}

void Supervisor::writer_appeared(std::string_view topic, const WriterSighting& sighting, Time now) {
  if (Watched* watched = this->watched(topic)) watched->right.appeared(sighting, now);
}

void Supervisor::writer_gone(std::string_view topic, const WriterId& writer) {
  Watched* watched = this->watched(topic);
  if (watched == nullptr) return;
  watched->right.gone(writer);
  if (watched == &watched_.front()) commanded_.reset();
}

void Supervisor::drive_command(const WriterId& writer, const geometry::Twist2& twist, Time now) {
  watched_.front().right.alive(writer, now);
  if (holder() != writer || !twist.finite()) return;
  commanded_ = Commanded{twist, now};
  drove_ = drove_ || twist.v != 0.0;
  turned_ = turned_ || twist.w != 0.0;
}

void Supervisor::base(const BaseReport& report, Time now) {
  if (!report.measured.finite()) {
    ++rejected_reports_;
    return;
  }
  // What it did while nothing was heard, or while its motors were off, says nothing of obedience.
  if (!base_heard(now) || !base_->ready || !report.ready) watch_.reset(report.measured);
  const bool refuses = !report.refusal.empty() && decision_.grant.writer != drive::kNobody;
  if (!refuses) refused_since_.reset();
  if (refuses && !refused_since_) refused_since_ = now;
  const bool stands_up = report.ready && !report.emergency;
  if (stands_up || (base_ && base_->emergency != report.emergency)) reset_until_.reset();
  base_ = report;
  base_at_ = now - report.age;
  if (report.ready) {
    const bool driven = decision_.grant.writer != drive::kNobody && commanded_ &&
                        now - commanded_->at < parameters_.command_expiry;
    watch_.observe(driven ? commanded_->twist : geometry::Twist2{}, report.measured, now);
  }
  take_epoch(report);
}

bool Supervisor::believes(const BaseReport& report) const {
  const auto base = std::ranges::find(watched_, parameters_.base_topic, &Watched::topic);
  return base != watched_.end() ? report.epoch < kHighestEpoch && base->right.holds(report.writer)
                                : report.epoch - epoch_ <= drive::kLongestLeap;
}

/// Another supervisor's epochs, or ours of before the memory was lost: continue above them. Not
/// above what somebody else says that the base has heard: further than by kLongestLeap it follows
/// no grant, and would be deaf for ever.
void Supervisor::take_epoch(const BaseReport& report) {
  if (report.epoch <= epoch_) return;
  if (!believes(report)) {
    ++rejected_reports_;
    return;
  }
  epoch_ = report.epoch;
  decision_.grant = {drive::kNobody, epoch_, drive::kNobody};
}

void Supervisor::movement(const std::string& barred_by, Time now) {
  const bool barred = !barred_by.empty() && decision_.state == State::kNavigationActive;
  if (!barred) barred_since_.reset();
  if (barred && !barred_since_) barred_since_ = now;
  barred_by_ = barred_by;
}

void Supervisor::navigation(std::uint64_t id, GoalState state) {
  navigation_id_ = id;
  navigation_ = state;
  if (!behavior_.navigation_wanted()) return;
  const bool active = state == GoalState::kActive || state == GoalState::kWaiting;
  if (active && behavior_.navigation_going()) active_goal_ = id;
  // The navigator also says the last words of goals that it refused while another one runs.
  const bool ours = active_goal_ ? id == *active_goal_ : id != id_before_goal_;
  if (over(state) && ours && !exploring_) behavior_.navigation_end();
}

void Supervisor::exploration(std::string_view client, bool lasts) {
  if (client.empty() || client != navigation_client_) return;
  if (exploring_ && !lasts) behavior_.navigation_end();
  exploring_ = lasts && behavior_.navigation_wanted();
}

Answer Supervisor::request(const Request& request, Time now) {
  HandledRing& ring = is_operator(request.client) ? handled_by_operators_ : handled_by_others_;
  for (const Handled& handled : ring.all) {
    if (request.own_name && handled.answer.id == request.id && handled.client == request.client &&
        !handled.client.empty()) {
      tell(handled, now);
      return handled.answer;
    }
  }
  Answer answer{request.id, false, carry_out(request, now)};
  answer.done = answer.reason.empty();
  if (!request.own_name) return answer;
  ring.all[ring.next] = {request.client, answer};
  tell(ring.all[ring.next], now);
  ring.next = (ring.next + 1) % ring.all.size();
  return answer;
}

void Supervisor::tell(const Handled& handled, Time now) {
  const bool waits = !is_operator(handled.client) && is_operator(last_client_) &&
                     now - answered_at_ < kOperatorsFirst;
  if (waits) return;
  last_request_ = handled.answer;
  last_client_ = handled.client;
  answered_at_ = now;
}

void Supervisor::stop(const std::string& client) {
  if (std::find(stopped_by_.begin(), stopped_by_.end(), client) != stopped_by_.end()) return;
  // So many names are not honest; the stop holds all the same, and only an operator ends it.
  if (stopped_by_.size() < kMostStops) {
    stopped_by_.push_back(client);
  } else {
    stopped_by_.back() = kOthers;
  }
}

bool Supervisor::is_operator(const std::string& client) const {
  const auto& operators = parameters_.operators;
  return std::find(operators.begin(), operators.end(), client) != operators.end();
}

void Supervisor::movement_on(const std::string& client) {
  if (is_operator(client)) {
    stopped_by_.clear();
  } else if (client != kOthers) {
    std::erase(stopped_by_, client);
  }
}

std::string Supervisor::carry_out(const Request& request, Time now) {
  const Fault* latched = faults_.latched();
  const auto not_now = [&]() -> std::string {
    if (latched) return "a fault must be cleared first: " + latched->detail;
    if (behavior_.state() == State::kInitialise) return "still initialising: " + reason_;
    return {};
  };
  if (!stops(request.command) && !request.own_name)
    return "asked by somebody else in the name of " + request.client;
  switch (request.command) {
    case Command::kStop:
      stop(request.client);
      return {};
    case Command::kMovementOn:
      movement_on(request.client);
      return {};
    case Command::kManualOn: {
      std::string refusal = not_now();
      if (refusal.empty()) behavior_.manual(true);
      return refusal;
    }
    case Command::kManualOff:
      behavior_.manual(false);
      return {};
    case Command::kNavigationStart: {
      if (request.goal.empty()) return "a goal's name was expected";
      if (behavior_.manual_wanted())
        return "an operator drives: Y on the gamepad, or usher teleop and then x, ends it";
      std::string refusal = not_now();
      if (!refusal.empty()) return refusal;
      behavior_.navigation_start();
      goal_ = request.goal;
      id_before_goal_ = navigation_id_;
      active_goal_.reset();
      navigation_client_ = request.client;
      exploring_ = false;
      return {};
    }
    case Command::kNavigationGo:
      if (!behavior_.navigation_wanted()) return "no goal was chosen";
      behavior_.navigation_go();
      return {};
    case Command::kNavigationEnd:
      behavior_.navigation_end();
      return {};
    case Command::kEmergencyStop:
      if (!request.own_name || !is_operator(request.client)) {
        stop(request.client);
        return "stopped; only an operator may switch the motors off";
      }
      faults_.raise(Cause::kEmergencyStop, request.client, "an emergency stop was requested", now);
      return {};
    case Command::kClear:
      if (!is_operator(request.client)) return "only an operator may clear faults";
      if (const Watched* watched = invaded()) {
        return "'" + watched->right.foreign()->participant + "' still writes " + watched->topic;
      }
      if (watch_.verdict() == drive::ResponseWatch::Verdict::kDisobeys)
        return "the base still moves other than commanded";
      if (faults_.active(Cause::kMovesWhileStopped) && commanded_ &&
          now - commanded_->at < parameters_.command_expiry && commanded_->twist.v != 0.0)
        return parameters_.names.movement + " still commands to drive";
      faults_.clear(request.client, now);
      watch_.reset();
      runs_away_ = false;
      if (base_ && (base_->emergency || !base_->ready))
        reset_until_ = now + parameters_.reset_patience;
      return {};
    case Command::kNone:
      break;
  }
  return "unknown command " + std::to_string(static_cast<int>(request.command));
}

void Supervisor::note_faults(Time now) {
  for (const ComponentHealth& component : table_.components()) {
    if (component.able()) {
      faults_.settle(Cause::kComponentLost, component.name, now);
    } else if (component.heard_at) {
      faults_.raise(Cause::kComponentLost, component.name, component.reason, now);
    }
  }
  for (const Watched& watched : watched_) {
    const WriterSighting* foreign = watched.right.foreign();
    if (foreign == nullptr) continue;
    faults_.raise(Cause::kForeignWriter,
                  foreign->participant.empty() ? "unnamed participant" : foreign->participant,
                  "writes " + watched.topic + " as " + drive::to_string(foreign->writer) +
                      " on host '" + foreign->host + "'",
                  now);
  }
  note_movement(now);
  note_base(now);
}

Time Supervisor::Lasting::see(bool there, Time now) {
  constexpr Time kGap = std::chrono::milliseconds(250);
  if (there) {
    if (!since) since = now;
    last = now;
  } else if (now - last >= kGap) {
    since.reset();
  }
  return since ? now - *since : Time::zero();
}

void Supervisor::note_movement(Time now) {
  const bool drove = std::exchange(drove_, false), turned = std::exchange(turned_, false);
  if (decision_.enables.movement || decision_.grant.writer == drive::kNobody) {
    drives_ = turns_ = spins_ = {};
    return;
  }
  const bool stands =
      base_heard(now) && std::abs(base_->measured.v) < kinematics::RollOut::kStanding;
  const Time drives = drives_.see(drove, now), turns = turns_.see(turned, now),
             spins = spins_.see(turned && stands, now);
  if (drives < parameters_.stop_patience && spins < parameters_.stop_patience &&
      turns < parameters_.roll_out_patience)
    return;
  faults_.raise(Cause::kMovesWhileStopped, parameters_.names.movement,
                drives > Time::zero() ? "commands to drive while movement is off"
                                      : "commands to turn while movement is off",
                now);
}

void Supervisor::note_base(Time now) {
  const drive::ResponseWatch::Verdict verdict = watch_.verdict();
  if (watch_.runs_away()) runs_away_ = true;
  if (verdict == drive::ResponseWatch::Verdict::kDisobeys) {
    faults_.raise(Cause::kDisobeyingBase, parameters_.names.base,
                  "moves other than commanded: linear error " +
                      std::to_string(watch_.linear().error) + " m/s, angular error " +
                      std::to_string(watch_.angular().error) + " rad/s",
                  now);
  } else if (verdict == drive::ResponseWatch::Verdict::kFallsShort) {
    faults_.raise(Cause::kBaseFallsShort, parameters_.names.base, "moves less than commanded", now);
  } else {
    faults_.settle(Cause::kBaseFallsShort, parameters_.names.base, now);
  }
  if (base_heard(now)) {
    faults_.settle(Cause::kBaseUnheard, parameters_.names.base, now);
  } else if (base_) {
    faults_.raise(Cause::kBaseUnheard, parameters_.names.base, "base/status is silent", now);
  }
  if (base_ && base_->emergency && !resetting(now)) {
    faults_.raise(Cause::kEmergencyStop, parameters_.names.base,
                  "its motors are off: an emergency stop, a fall, or somebody switched it off",
                  now);
  }
}

/// The heartbeats of its name are those of its next start already.
bool Supervisor::movement_died(Time now) const {
  return watched_.front().right.doubted(now, table_.timeout(parameters_.names.movement));
}

std::string_view Supervisor::refusal(Time now) const {
  if (refused_since_ && now - *refused_since_ >= parameters_.refusal_patience)
    return base_->refusal;
  return faults_.active(Cause::kBaseFallsShort) ? text(Cause::kBaseFallsShort) : std::string_view();
}

double Supervisor::charge() const {
  const bool heard = base_ && !faults_.active(Cause::kBaseUnheard);
  return heard ? base_->battery_percent : std::numeric_limits<double>::quiet_NaN();
}

void Supervisor::explain(Time now) {
  if (const Fault* latched = faults_.latched()) {
    reason_.assign(text(latched->cause)).append(": ").append(latched->component);
    reason_.append(": ").append(latched->detail);
  } else if (const ComponentHealth* missing = table_.first_lost(Criticality::kStop)) {
    reason_.assign(missing->name).append(": ").append(missing->reason);
  } else if (!holder()) {
    reason_.assign(parameters_.names.movement).append(": writes no drive/command yet");
  } else if (movement_died(now)) {
    reason_.assign(parameters_.names.movement).append(": starts anew");
  } else if (!base_heard(now)) {
    reason_.assign(parameters_.names.base)
        .append(base_ ? ": base/status is silent" : ": no base/status yet");
  } else if (base_->emergency) {
    reason_.assign("the base leaves its emergency stop");
  } else if (!base_->ready) {
    reason_.assign(parameters_.names.base)
        .append(": the base is disconnected or its motors are off");
  } else if (!stopped_by_.empty()) {
    reason_.assign("stopped by ").append(stopped_by_.front());
    for (std::size_t i = 1; i < stopped_by_.size(); ++i)
      reason_.append(", ").append(stopped_by_[i]);
  } else if (const std::string_view refused = refusal(now); !refused.empty()) {
    reason_.assign(parameters_.names.base).append(": ").append(refused);
  } else if (barred_since_ && now - *barred_since_ >= parameters_.barred_patience) {
    reason_.assign(parameters_.names.movement).append(": ").append(barred_by_);
  } else if (const ComponentHealth* lost = table_.first_lost(Criticality::kDegrade)) {
    reason_.assign(lost->name).append(": ").append(lost->reason);  // it may stand for want of it
  } else {
    reason_.clear();
  }
}

void Supervisor::grant(bool able) {
  const bool may = able && !faults_.latched() && decision_.state != State::kInitialise &&
                   decision_.state != State::kFault;
  const drive::WriterId writer = may ? *holder() : drive::kNobody;
  if (may && writer != decision_.grant.writer) ++epoch_;
  decision_.grant = {writer, epoch_, drive::kNobody};
}

const Decision& Supervisor::step(Time now) {
  table_.judge(now);
  note_faults(now);
  const bool able = !table_.first_lost(Criticality::kStop) && holder() && !movement_died(now) &&
                    base_heard(now) && !base_->emergency && base_->ready;
  const bool fault = faults_.latched() != nullptr;
  decision_.state = behavior_.step(able, fault, now);
  grant(able);

  decision_.enables = enables_of(decision_.state);
  if (!stopped_by_.empty()) decision_.enables.movement = false;
  decision_.speed_factor = table_.degraded() ? parameters_.degraded_speed_factor : 1.0;
  decision_.emergency_stop = faults_.active(Cause::kEmergencyStop) ||
                             (parameters_.emergency_stop_when_disobeying && runs_away_);
  decision_.reset_base = resetting(now) && !fault;
  decision_.camera_angle = camera_angle_in(decision_.state, parameters_);
  explain(now);
  decision_.reason = reason_;
  if (!behavior_.navigation_wanted()) goal_.clear();
  return decision_;
}

SupervisorStatus Supervisor::status() const {
  const Names& names = parameters_.names;
  const auto able = [this](const std::string& name) {
    const ComponentHealth* component = table_.find(name);
    return component && component->able();
  };
  const auto connected = [this](const std::string& name) {
    const ComponentHealth* component = table_.find(name);
    return component && component->health != Health::kMissing;
  };
  SupervisorStatus status;
  status.timeout_movement = table_.timeout(names.movement);
  status.timeout_interaction = table_.timeout(names.interaction);
  status.timeout_power = parameters_.base_age;
  status.process_rate = parameters_.process_rate;
  status.camera_angle_default = parameters_.camera_angle_default;
  status.camera_angle_interaction = parameters_.camera_angle_interaction;
  status.camera_angle_navigation = parameters_.camera_angle_navigation;
  status.state = decision_.state;
  status.current_goal = goal_;
  status.navigation = navigation_;
  status.ok_movement = able(names.movement);
  status.ok_interaction = able(names.interaction);
  status.ok_power = charge() > 0.0;
  status.connected_movement = connected(names.movement);
  status.connected_interaction = connected(names.interaction);
  status.connected_power = !std::isnan(charge());
  status.connected_gui = connected(names.gui);
  status.connected_navigation = connected(names.navigation);
  status.enables = decision_.enables;
  status.granted = decision_.grant.writer != drive::kNobody;
  status.epoch = epoch_;
  status.speed_factor = decision_.speed_factor;
  status.camera_angle = decision_.camera_angle;
  status.reason = reason_;
  status.stopped_by = stopped_by_;
  status.components = table_.components();
  status.faults = faults_.faults();
  for (const Watched& watched : watched_) {
    for (const drive::WriterRight::Known& known : watched.right.writers()) {
      const bool foreign = known.role == drive::WriterRight::Role::kForeign;
      if (!watched.moves && !foreign) continue;
      status.writers.push_back({watched.topic, known.sighting, known.since, !foreign,
                                status.granted && known.sighting.writer == decision_.grant.writer});
    }
  }
  status.last_request = last_request_;
  status.last_client = last_client_;
  return status;
}

void Supervisor::memory_kept(const Status& outcome, Time now) {
  if (outcome) {
    faults_.settle(Cause::kNotKept, kItself, now);
  } else {
    faults_.raise(Cause::kNotKept, kItself, outcome.error(), now);
  }
}

Memory Supervisor::memory() const {
  Memory memory;
  memory.epoch = epoch_;
  memory.stopped_by = stopped_by_;
  memory.manual = behavior_.manual_wanted();
  for (const Fault& fault : faults_.faults()) {
    if (fault.active && fault.latched()) memory.latched.push_back(fault);
  }
  return memory;
}

}  // namespace usher::supervisor
