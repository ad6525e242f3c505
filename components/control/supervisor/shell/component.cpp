#include "control/supervisor/shell/component.hpp"

#include <utility>

#include "drivers/base_obedience/shell/read_response.hpp"
#include "wire/conversions.hpp"
#include "wire/manifest.hpp"

namespace usher::supervisor {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kPeriod = milliseconds(20);
constexpr int kStatusEvery = 5;        // of those periods: 10 Hz
constexpr int kDiagnosticsEvery = 50;  // 1 Hz
constexpr auto kBaseAge = milliseconds(150);
constexpr auto kMovementAge = milliseconds(500);
constexpr auto kExplorerAge = milliseconds(2000);
constexpr const char* kMemoryKey = "supervisor";
constexpr int kMostComponents = 64;
constexpr std::size_t kMostWriters = 64;  // in the status

float single(double value) { return static_cast<float>(value); }
float in_seconds(Time time) { return single(std::chrono::duration<double>(time).count()); }
Time time_from(double seconds) { return runtime::from_seconds(seconds); }

/// Of a heartbeat; what is no time counts as none.
Time handler_time(float seconds) {
  return seconds > 0.0F && seconds < 1e6F ? runtime::from_seconds(seconds) : Time::zero();
}

/// That nobody has the right, the supervisor knows by itself; a foreign command changes nothing.
std::string refusal_of(const usher_msgs::msg::BaseStatus& status) {
  const auto is = [&](drive::Reason reason) {
    return status.obedience() == static_cast<std::uint8_t>(reason);
  };
  return is(drive::Reason::kObeyed) || is(drive::Reason::kForeignWriter) ? std::string()
                                                                         : status.reason();
}

/// Why movement_control lets the robot not go forward; empty when it does, or nobody wants it.
std::string limit_reason_of(const usher_msgs::msg::MovementStatus& status) {
  if (status.velocity_current_linear() > 0.0F) return {};
  // The planner minds a touch, too, and then wants nothing that could be barred.
  const bool touched =
      status.front_left() || status.front_right() || status.back_left() || status.back_right();
  if (touched) return "a whisker is touched";
  // Where nobody drives the turn rate is that of the arc on which it rolls out.
  const bool turns = status.velocity_current_angular() != 0.0F &&
                     status.source() != usher_msgs::msg::MovementStatus_Constants::SOURCE_NONE;
  return status.velocity_current_linear() == 0.0F && !turns ? status.limit_reason() : std::string();
}

Criticality criticality_from(const std::string& word) {
  if (word == "degrade") return Criticality::kDegrade;
  if (word == "notify") return Criticality::kNotify;
  return Criticality::kStop;  // whatever else it says: the safe one
}

}  // namespace

void SupervisorComponent::watch_topics(const std::vector<drive::NamedComponent>& manifest,
                                       std::vector<WatchedTopic>& watched) {
  const auto moves = [&](const auto&... topic) {
    (watched.push_back(
         {std::string(topic.name), drive::allowed_writers(topic.writers, manifest), true}),
     ...);
  };
  moves(topics::kCmdVelManual, topics::kCmdVelInteraction, topics::kCmdVelNavigation,
        topics::kDriveGrant, topics::kMovementEnable, topics::kBaseRequest);
  // What no component of the manifest writes may come from a driver of somebody else.
  const auto tells = [&](const auto& topic) {
    auto names = drive::allowed_writers(topic.writers, manifest);
    if (!names.empty()) watched.push_back({std::string(topic.name), std::move(names), false});
  };
  const auto tell = [&](const auto&... topic) { (tells(topic), ...); };
  tell(topics::kJoy, topics::kBaseStatus, topics::kOdom, topics::kTf, topics::kTfStatic);
  tell(topics::kScan, topics::kScanFiltered, topics::kUltrasonic, topics::kUltrasonicFiltered,
       topics::kWhiskers, topics::kKinectScan, topics::kKinectScanLow, topics::kRearScan,
       topics::kPeople, topics::kPersonAhead);
  tell(topics::kMap, topics::kAmclPose, topics::kLocalizationStatus, topics::kLocalCosts,
       topics::kGlobalCosts, topics::kCostmapRequest);
  tell(topics::kPlanRequest, topics::kPlanReply, topics::kFollowGoal, topics::kFollowCancel,
       topics::kFollowStatus, topics::kNavigateStatus, topics::kNavigatePace, topics::kLocations,
       topics::kExploreStatus, topics::kExploreShare, topics::kMovementStatus,
       topics::kSupervisorStatus);
  tell(topics::kKinectDepth, topics::kKinectInfo, topics::kKinectColor, topics::kKinectProcessed,
       topics::kKinectTilt, topics::kKinectTiltCommand, topics::kRearDepth, topics::kRearInfo,
       topics::kRearColor, topics::kRearProcessed, topics::kFaces);
  tell(topics::kInteractionTarget, topics::kTorsoFrame, topics::kTorsoStatus, topics::kVisitor,
       topics::kGuideStatus, topics::kMeetingStatus, topics::kDialogueScreen,
       topics::kSpeechStatus);
}

Parameters SupervisorComponent::read_parameters(runtime::Host& host) {
  auto& parameters = host.parameters();
  Parameters p;
  p.base_age = kBaseAge;
  p.idl_digest = USHER_IDL_DIGEST;
  const auto components = wire::read_manifest(host);
  std::vector<drive::NamedComponent> manifest;
  for (const auto& record : components) {
    manifest.push_back({record.text("name"), record.text("type")});
    if (record.text("name") == host.name()) continue;  // who grants is alive
    p.components.push_back({record.text("name"), criticality_from(record.text("criticality")),
                            time_from(record.number("timeout"))});
  }
  p.names.movement = parameters.text("movement_name", p.names.movement,
                                     "The component that may write drive/command.");
  p.topics = {{std::string(topics::kDriveCommand.name), {p.names.movement}}};
  p.base_topic = topics::kBaseStatus.name;
  watch_topics(manifest, p.topics);
  p.names.interaction = parameters.text("interaction_name", p.names.interaction,
                                        "The component that poses the robot.");
  p.names.gui =
      parameters.text("gui_name", p.names.gui, "The component with the visitor's screen.");
  p.names.navigation =
      parameters.text("navigation_name", p.names.navigation, "The component that takes goals.");
  const auto bases = drive::allowed_writers(topics::kBaseStatus.writers, manifest);
  if (!bases.empty()) p.names.base = bases.front();
  p.dwell = time_from(parameters.number("dwell", "s", {0.05, 5}, 0.25,
                                        "Least time in Inactive between two behaviors."));
  p.degraded_speed_factor =
      parameters.number("degraded_speed_factor", "-", {0, 1}, p.degraded_speed_factor,
                        "Factor on all speeds while something is degraded.");
  p.movement_on_at_start =
      parameters.flag("movement_on_at_start", p.movement_on_at_start,
                      "Whether the robot may move without being told so first.");
  p.emergency_stop_when_disobeying =
      parameters.flag("emergency_stop_when_disobeying", p.emergency_stop_when_disobeying,
                      "Switch the motors of a base off that moves otherwise than it is told by "
                      "more than the thresholds.");
  p.response = drive::read_response(parameters);
  return p;
}

/// An unreadable memory must not be taken for none: latched faults would be forgotten.
Memory SupervisorComponent::remembered(runtime::Host& host, const std::string& kept) {
  if (kept.empty()) return {};
  auto memory = memory_from_text({reinterpret_cast<const std::uint8_t*>(kept.data()), kept.size()});
  if (!memory) host.fault("what was kept over the restart cannot be read: " + memory.error());
  return std::move(memory).value();
}

SupervisorComponent::SupervisorComponent(runtime::Host& host)
    : host_(host),
      grant_valid_for_(host.parameters().number("grant_valid_for", "s", {0.04, 0.12}, 0.12,
                                                "Life of a grant without renewal.")),
      parameters_(read_parameters(host)),
      memory_(host, kMemoryKey, [this](const Status& kept) { core_.memory_kept(kept, now()); }),
      core_(parameters_, remembered(host, memory_.found())),
      unknown_heartbeats_(host.health().counter("heartbeats: unknown")),
      rejected_reports_(host.health().counter("reports: rejected")) {
  heartbeat_ =
      host.input(topics::kHeartbeat, {.depth = 4 * kMostComponents},
                 [this](const auto& message, const auto& info) {
                   core_.heartbeat(
                       {message.component_name(), info.writer, message.idl_digest(),
                        static_cast<Reported>(std::min<std::uint8_t>(message.state(), 3)),
                        message.reason(), message.host(), handler_time(message.handler_time_max())},
                       info.effective.time_since_epoch());
                 });
  command_ = host.input(topics::kDriveCommand, {.optional = true},
                        [this](const auto& message, const auto& info) {
                          core_.drive_command(info.writer, {message.v(), message.w()},
                                              info.effective.time_since_epoch());
                        });
  base_ = host.input(topics::kBaseStatus,
                     {.max_age = kBaseAge, .on_loss = "withdraws the right to drive"},
                     [this](const auto& message, const auto& info) {
                       using namespace usher_msgs::msg::BaseStatus_Constants;
                       core_.base({message.state() == STATE_EMERGENCY,
                                   message.state() == STATE_BALANCING,
                                   {message.v(), message.w()},
                                   message.epoch(),
                                   host_.now() - info.effective,
                                   refusal_of(message),
                                   message.battery_percent(),
                                   info.writer},
                                  now());
                     });
  movement_ = host.input(
      topics::kMovementStatus,
      {.max_age = kMovementAge, .on_loss = "does not tell why it stands", .optional = true},
      [this](const auto& message, const auto&) { core_.movement(limit_reason_of(message), now()); },
      [this] { core_.movement({}, now()); });
  navigation_ = host.input(
      topics::kNavigateStatus, {.optional = true}, [this](const auto& message, const auto&) {
        core_.navigation(message.id(),
                         static_cast<GoalState>(std::min<std::uint8_t>(message.state(), 6)));
      });
  exploration_ = host.input(
      topics::kExploreStatus,
      {.max_age = kExplorerAge,
       .on_loss = "each goal of the navigator ends the navigation again",
       .optional = true},
      [this](const auto& message, const auto&) {
        using namespace usher_msgs::msg::GoalStatus_Constants;
        core_.exploration(message.client(),
                          message.state() == STATE_ACTIVE || message.state() == STATE_WAITING);
      },
      [this] { core_.exploration_lost(); });
  request_ = host.input(
      topics::kSupervisorRequest, {.optional = true},
      [this](const auto& message, const auto& info) { take_request(message, info.writer); });
  for (const WatchedTopic& topic : parameters_.topics) watch(topic.name);
  grant_ = host.output(topics::kDriveGrant);
  enable_ = host.output(topics::kMovementEnable);
  base_requests_ = host.output(topics::kBaseRequest);
  status_ = host.output(topics::kSupervisorStatus);
  diagnostics_ = host.output(topics::kDiagnostics);
  timer_ = host.timer("step", kPeriod, [this](auto) {
    step();
    const bool answer = std::exchange(answer_later_, false);
    if (answer) answered_at_ = now();
    if (++status_share_ % kStatusEvery == 0 || answer) publish_status();
    if (status_share_ % kDiagnosticsEvery == 0) publish_diagnostics(core_.status());
  });
}

void SupervisorComponent::watch(const std::string& topic) {
  host_.watch_writers(topic, [this, topic](const runtime::WriterInfo& writer) {
    introduce_itself();
    if (writer.alive) {
      core_.writer_appeared(topic, {writer.guid, writer.participant, writer.host}, now());
    } else {
      core_.writer_gone(topic, writer.guid);
    }
    step();
  });
}

/// The name of the participant that wrote a request; empty where discovery does not know it.
const std::string& SupervisorComponent::asker(const runtime::Guid& writer) {
  if (asker_.guid == writer) return asker_.participant;
  const auto all = request_.writers();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.guid == writer; });
  asker_ = found == all.end() ? runtime::WriterInfo{} : *found;
  if (asker_.participant.empty()) asker_.guid = {};  // asks again when it is known
  return asker_.participant;
}

void SupervisorComponent::take_request(const usher_msgs::msg::SupervisorRequest& message,
                                       const runtime::Guid& writer) {
  const std::string& asks = asker(writer);
  // A sample may come before discovery tells who its writer is: who asks for more than a stop is
  // answered when that is known. Requests are repeated.
  const bool known = !asks.empty();
  const auto command = static_cast<Command>(message.command());
  const Request request{message.id(), message.client(), command, message.goal(),
                        known ? asks == message.client() : command == Command::kStop};
  if (!known && !stops(command)) return;
  core_.request(request, now());
  if (!request.own_name && !stops(request.command)) return;
  // The first one acts and is answered at once; a flood of them must not become one of answers.
  answer_later_ = now() - answered_at_ < kPeriod;
  if (answer_later_) return;
  answered_at_ = now();
  step();
  publish_status();
}

/// Before anybody else, so that another writer of these topics is a second one, whatever its name.
void SupervisorComponent::introduce_itself() {
  if (std::exchange(introduced_, true)) return;
  const auto introduce = [this](std::string_view topic, const runtime::Guid& writer) {
    core_.writer_appeared(topic, {writer, host_.name(), host_.host_name()}, now());
  };
  introduce(topics::kDriveGrant.name, grant_.guid());
  introduce(topics::kMovementEnable.name, enable_.guid());
  introduce(topics::kBaseRequest.name, base_requests_.guid());
  introduce(topics::kSupervisorStatus.name, status_.guid());
}

void SupervisorComponent::step() {
  introduce_itself();
  core_.alive(grant_.guid(), now());
  const Decision& decision = core_.step(now());
  publish_grant(decision);
  publish_enable(decision);
  ask_base(decision);
  // What a crash loses before the disk has it is an epoch at most, which a restart skips, or a stop
  // of the last milliseconds. A full disk stops no robot: the operator reads what would be
  // forgotten.
  if (const Memory memory = core_.memory(); memory != told_memory_) {
    memory_.keep(to_text(memory));
    told_memory_ = memory;
  }
  unknown_heartbeats_ = core_.unknown_heartbeats();
  rejected_reports_ = core_.rejected_reports();
  const bool fault = decision.state == State::kFault;
  host_.health().set(fault ? HealthState::kDegraded : HealthState::kOk,
                     fault ? std::string(decision.reason) : "");
  if (std::exchange(told_fault_, fault) != fault) publish_status();
}

void SupervisorComponent::publish_grant(const Decision& decision) {
  usher_msgs::msg::DriveGrant message;
  message.stamp(wire::to_message(host_.now()));
  message.epoch(decision.grant.epoch);
  message.granted(decision.grant.writer != drive::kNobody);
  message.writer(decision.grant.writer);
  message.valid_for(single(grant_valid_for_));
  message.reason(message.granted() ? std::string() : std::string(decision.reason));
  grant_.publish(message);
}

void SupervisorComponent::publish_enable(const Decision& decision) {
  usher_msgs::msg::MovementEnable message;
  message.header(wire::header(host_.now(), ""));
  message.movement(decision.enables.movement);
  message.manual(decision.enables.manual);
  message.interaction(decision.enables.interaction);
  message.navigation(decision.enables.navigation);
  message.interaction_control(decision.enables.interaction_control);
  message.speed_factor(single(decision.speed_factor));
  message.epoch(decision.grant.epoch);
  enable_.publish(message);
}

void SupervisorComponent::ask_base(const Decision& decision) {
  using namespace usher_msgs::msg::BaseRequest_Constants;
  const std::uint8_t wanted = decision.emergency_stop ? COMMAND_EMERGENCY_STOP
                              : decision.reset_base   ? COMMAND_RESET
                                                      : COMMAND_NONE;
  if (wanted != base_request_) ++base_request_id_;
  base_request_ = wanted;
  if (wanted == COMMAND_NONE) return;
  usher_msgs::msg::BaseRequest message;
  // Unique over restarts, so that a request after one is not taken for a repetition.
  message.id(static_cast<std::uint64_t>(decision.grant.epoch) << 20 | base_request_id_);
  message.client(host_.name());
  message.command(wanted);
  base_requests_.publish(message);
}

void SupervisorComponent::publish_status() {
  const SupervisorStatus s = core_.status();
  usher_msgs::msg::SupervisorStatus m;
  m.header(wire::header(host_.now(), ""));
  m.timeout_movement(in_seconds(s.timeout_movement));
  m.timeout_interaction(in_seconds(s.timeout_interaction));
  m.timeout_power(in_seconds(s.timeout_power));
  m.process_rate(single(s.process_rate));
  m.kinect_angle_default(single(s.camera_angle_default));
  m.kinect_angle_interaction(single(s.camera_angle_interaction));
  m.kinect_angle_navigation(single(s.camera_angle_navigation));
  m.state(static_cast<std::uint8_t>(s.state));
  m.current_goal(s.current_goal);
  m.navigation_status(static_cast<std::uint8_t>(s.navigation));
  m.ok_movement(s.ok_movement);
  m.ok_interaction(s.ok_interaction);
  m.ok_power(s.ok_power);
  m.connected_movement(s.connected_movement);
  m.connected_interaction(s.connected_interaction);
  m.connected_power(s.connected_power);
  m.connected_gui(s.connected_gui);
  m.connected_navigation(s.connected_navigation);
  m.enable_movement(s.enables.movement);
  m.enable_manual(s.enables.manual);
  m.enable_interaction(s.enables.interaction);
  m.enable_navigation(s.enables.navigation);
  m.enable_interaction_control(s.enables.interaction_control);
  m.speed_factor(single(s.speed_factor));
  m.kinect_angle(single(s.camera_angle));
  m.granted(s.granted);
  m.epoch(s.epoch);
  m.reason(s.reason);
  m.stopped_by(s.stopped_by);
  for (const auto& writer : s.writers) {
    if (m.writers().size() >= kMostWriters) break;
    auto& entry = m.writers().emplace_back();
    entry.topic(writer.topic);
    entry.participant(writer.sighting.participant);
    entry.host(writer.sighting.host);
    entry.writer(writer.sighting.writer);
    entry.since(wire::to_message(runtime::Time(writer.since)));
    entry.allowed(writer.allowed);
    entry.granted(writer.granted);
  }
  for (const auto& component : s.components) {
    auto& entry = m.components().emplace_back();
    entry.name(component.name);
    entry.criticality(static_cast<std::uint8_t>(component.criticality));
    entry.health(static_cast<std::uint8_t>(component.health));
    entry.age(component.heard_at ? in_seconds(now() - *component.heard_at) : -1.0F);
    entry.reason(component.reason);
    entry.host(component.host);
    entry.handler_time_max(in_seconds(component.longest_handler));
    entry.restarts(component.restarts);
  }
  for (const auto& fault : s.faults) {
    auto& entry = m.faults().emplace_back();
    entry.id(fault.id);
    entry.stamp(wire::to_message(runtime::Time(fault.at)));
    entry.component_name(fault.component);
    entry.cause(std::string(text(fault.cause)) + (fault.detail.empty() ? "" : ": " + fault.detail));
    entry.latched(fault.latched());
    entry.active(fault.active);
    entry.ended(wire::to_message(runtime::Time(fault.ended)));
    entry.ended_by(fault.ended_by);
  }
  m.last_request(s.last_request.id);
  m.last_request_done(s.last_request.done);
  m.last_request_reason(s.last_request.reason);
  m.last_request_client(s.last_client);
  status_.publish(m);
}

void SupervisorComponent::publish_diagnostics(const SupervisorStatus& status) {
  if (diagnostics_.reader_count() == 0) return;
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header(wire::header(host_.now(), ""));
  for (const auto& component : status.components) {
    auto& entry = message.status().emplace_back();
    const bool well = component.health == Health::kOk;
    entry.level(static_cast<std::uint8_t>(well ? 0 : component.able() ? 1 : 2));
    entry.name("usher: " + component.name);
    entry.message(well ? "OK" : component.reason);
    entry.hardware_id("usher");
  }
  diagnostics_.publish(message);
}

}  // namespace usher::supervisor
