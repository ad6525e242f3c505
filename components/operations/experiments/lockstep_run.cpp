#include "operations/experiments/lockstep_run.hpp"

#include "operations/all_components/all_components.hpp"

namespace usher::operations {

LockstepRun::LockstepRun(std::uint64_t seed) : world_({.network = {.seed = seed}}) {
  const auto take = [this](const auto& message, const auto&) { record_.take(message); };
  world_.observe(topics::kSimGroundTruth, take);
  world_.observe(topics::kAmclPose, take);
  world_.observe(topics::kPlan, take);
  world_.observe(topics::kNavigateStatus, take);
  world_.observe(topics::kDialogueScreen, take);
  world_.observe(topics::kCmdVelNavigation, take);
  world_.observe(topics::kDriveCommand, take);
  world_.observe(topics::kWhiskers, take);
  world_.observe(topics::kHeartbeat, [this](const auto& message, const auto&) {
    heartbeats_[message.component_name()] = message;
  });
}

std::string LockstepRun::complaints() const {
  std::string out;
  for (const auto& [name, heartbeat] : heartbeats_) {
    std::string line = heartbeat.reason();
    for (const auto& counter : heartbeat.counters()) {
      if (counter.count() > 0)
        line += (line.empty() ? "" : "; ") + counter.name() + " " + std::to_string(counter.count());
    }
    if (!line.empty()) out += "  " + name + ": " + line + "\n";
  }
  return out;
}

Result<std::unique_ptr<LockstepRun>> LockstepRun::create(const Deployment& deployment,
                                                         std::uint64_t seed) {
  if (!deployment.findings.empty()) {
    const auto& first = deployment.findings.front();
    return Error{to_string(first.verdict) + ": " + first.text + " (" + first.origin + ")"};
  }
  std::unique_ptr<LockstepRun> run(new LockstepRun(seed));
  for (auto file : deployment.files) {
    const auto* factory = find_component(file.component);
    if (factory == nullptr) return Error{"unknown component type '" + file.component + "'"};
    file.seed = seed;
    // A restarted process is back within a moment, as under the launcher.
    const std::string name = file.name;
    if (auto status = run->world_.add(*factory, std::move(file),
                                      {.restart_after = std::chrono::milliseconds(100)});
        !status) {
      return Error{name + ": " + status.error()};
    }
  }
  return run;
}

}  // namespace usher::operations
