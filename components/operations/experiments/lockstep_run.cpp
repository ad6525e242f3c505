#include "operations/experiments/lockstep_run.hpp"

#include "operations/all_components/all_components.hpp"

namespace usher::operations {

LockstepRun::LockstepRun(std::uint64_t seed) : world_({.network = {.seed = seed}}) {}

void LockstepRun::watch(const std::string& robot) {
  RunRecord& record = records_[robot];
  const auto take = [&record](const auto& message, const auto&) { record.take(message); };
  world_.observe(topics::kSimGroundTruth, take, robot);
  world_.observe(topics::kAmclPose, take, robot);
  world_.observe(topics::kPlan, take, robot);
  world_.observe(topics::kNavigateStatus, take, robot);
  world_.observe(topics::kDialogueScreen, take, robot);
  world_.observe(topics::kCmdVelNavigation, take, robot);
  world_.observe(topics::kDriveCommand, take, robot);
  world_.observe(topics::kWhiskers, take, robot);
  world_.observe(
      topics::kHeartbeat,
      [this, robot](const auto& message, const auto&) {
        heartbeats_[(robot.empty() ? "" : robot + "/") + message.component_name()] = message;
      },
      robot);
}

std::string LockstepRun::complaints() const {
  std::string out;
  for (const auto& [name, heartbeat] : heartbeats_) {
    std::string line = heartbeat.reason();
    for (const auto& counter : heartbeat.counters()) {
      if (counter.count() == 0) continue;
      if (!line.empty()) line += "; ";
      line += counter.name();
      line += ' ';
      line += std::to_string(counter.count());
    }
    if (line.empty()) continue;
    out += "  ";
    out += name;
    out += ": ";
    out += line;
    out += '\n';
  }
  return out;
}

std::uint64_t LockstepRun::counter(const std::string& component, const std::string& name) const {
  const auto found = heartbeats_.find(component);
  if (found == heartbeats_.end()) return 0;
  for (const auto& counter : found->second.counters())
    if (counter.name() == name) return counter.count();
  return 0;
}

Status LockstepRun::add(const Deployment& deployment, std::uint64_t seed) {
  if (!deployment.findings.empty()) {
    const auto& first = deployment.findings.front();
    return Error{to_string(first.verdict) + ": " + first.text + " (" + first.origin + ")"};
  }
  watch(deployment.manifest.fleet.robot);
  for (auto file : deployment.files) {
    const auto* factory = find_component(file.component);
    if (factory == nullptr) return Error{"unknown component type '" + file.component + "'"};
    file.seed = seed;
    // A restarted process is back within a moment, as under the launcher.
    const std::string name = file.name;
    if (auto status = world_.add(*factory, std::move(file),
                                 {.restart_after = std::chrono::milliseconds(100)});
        !status) {
      return Error{name + ": " + status.error()};
    }
  }
  return {};
}

Result<std::unique_ptr<LockstepRun>> LockstepRun::create(const Deployment& deployment,
                                                         std::uint64_t seed) {
  return create(std::span(&deployment, 1), seed);
}

Result<std::unique_ptr<LockstepRun>> LockstepRun::create(std::span<const Deployment> fleet,
                                                         std::uint64_t seed) {
  std::unique_ptr<LockstepRun> run(new LockstepRun(seed));
  for (const Deployment& deployment : fleet) {
    if (Status added = run->add(deployment, seed); !added) return Error{added.error()};
  }
  return run;
}

}  // namespace usher::operations
