#include "runtime/lockstep/lockstep_world.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace usher::runtime {

LockstepWorld::LockstepWorld() : LockstepWorld(Options{}) {}

LockstepWorld::LockstepWorld(const Options& options)
    : start_(options.start), schedule_(options.start), network_(schedule_, options.network) {}

LockstepWorld::~LockstepWorld() = default;

Status LockstepWorld::add(ComponentFactory factory, ParameterFile file,
                          LockstepHost::Options options) {
  const bool known = std::any_of(hosts_.begin(), hosts_.end(), [&](const auto& each) {
    return each->file().name == file.name && each->file().robot == file.robot;
  });
  if (known) return Error{"the name " + file.name + " is given twice"};
  hosts_.push_back(std::make_unique<LockstepHost>(static_cast<std::uint32_t>(hosts_.size()),
                                                  schedule_, network_, std::move(factory),
                                                  std::move(file), options));
  return hosts_.back()->start();
}

LockstepHost& LockstepWorld::host(const std::string& name) const {
  for (const auto& each : hosts_) {
    if (each->name() == name) return *each;
  }
  throw std::out_of_range("no component " + name + " in this world");
}

std::vector<std::string> LockstepWorld::components() const {
  std::vector<std::string> names;
  for (const auto& each : hosts_) names.push_back(each->name());
  return names;
}

void LockstepWorld::when_idle(std::function<void()> action) {
  if (turning_) {
    schedule_.add_action(now(), std::move(action));
  } else {
    action();
  }
}

void LockstepWorld::kill(const std::string& name) {
  when_idle([&its_host = host(name)] { its_host.kill(); });
}

void LockstepWorld::kill(const std::string& name, Duration back_after) {
  when_idle([&its_host = host(name), back_after] { its_host.kill(back_after); });
}

void LockstepWorld::stop(const std::string& name) {
  when_idle([&its_host = host(name)] { its_host.stop(); });
}

void LockstepWorld::start(const std::string& name) {
  // A failed start is told by running() and fault_reason().
  when_idle([&its_host = host(name)] { static_cast<void>(its_host.start()); });
}

void LockstepWorld::hang(const std::string& name, Duration duration) {
  host(name).hang(now() + duration);
}

void LockstepWorld::jump_clock(const std::string& host, Duration by) {
  network_.jump_clock(host, by);
  for (const auto& each : hosts_) {
    if (each->host_name() == host) each->clock_jumped();
  }
}

void LockstepWorld::run_until(Time time) {
  Schedule::Event event;
  while (schedule_.next(time, event)) {
    switch (event.rank) {
      case Schedule::Rank::kAction:
        schedule_.take_action(event.index)();
        break;
      case Schedule::Rank::kDelivery:
        network_.deliver(event.index);
        break;
      case Schedule::Rank::kTurn:
        turning_ = true;
        hosts_[event.index]->turn();
        turning_ = false;
        break;
    }
  }
  schedule_.advance_to(std::max(time, now()));
}

Transport::Writer& LockstepWorld::outsider_writer(const OutputDeclaration& declaration,
                                                  const Speaker& speaker) {
  auto found = outsiders_.find(speaker);
  if (found == outsiders_.end()) {
    // Without a host it lives beside the robot's first component, so that its stamps count there.
    const auto first = std::find_if(hosts_.begin(), hosts_.end(), [&](const auto& each) {
      return speaker.robot.empty() || each->file().robot == speaker.robot;
    });
    const std::string fallback = first == hosts_.end() ? "localhost" : (*first)->file().host;
    const auto id = network_.join(
        speaker.participant, speaker.host.empty() ? fallback : speaker.host, true, speaker.robot);
    network_.announce(id);
    found = outsiders_.emplace(speaker, Outsider{id, {}}).first;
  }
  auto& writer =
      found->second.writers[declaration.topic + ' ' + std::string(declaration.type->name)];
  if (writer == nullptr) writer = &network_.open_writer(found->second.id, declaration);
  return *writer;
}

void LockstepWorld::publish(const OutputDeclaration& declaration, const void* message,
                            const Speaker& speaker) {
  Bytes cdr;
  if (!declaration.type->serialize(message, cdr)) throw std::bad_alloc();
  write_bytes(declaration, std::move(cdr), speaker);
}

void LockstepWorld::write_bytes(const OutputDeclaration& declaration, Bytes cdr,
                                const Speaker& speaker) {
  outsider_writer(declaration, speaker).write(std::make_shared<const Bytes>(std::move(cdr)));
}

void LockstepWorld::leave(const std::string& participant, const std::string& host) {
  const auto found = outsiders_.find({participant, host, {}});
  if (found == outsiders_.end()) return;
  network_.leave(found->second.id);
  outsiders_.erase(found);
}

}  // namespace usher::runtime
