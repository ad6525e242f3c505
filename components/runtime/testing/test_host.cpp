#include "runtime/testing/test_host.hpp"

#include <sstream>
#include <stdexcept>

namespace usher::runtime {
namespace {

LockstepWorld::Options options(std::uint64_t seed) {
  LockstepWorld::Options options;
  options.network.seed = seed;
  options.network.discovery = Duration::zero();
  return options;
}

}  // namespace

Result<ParameterFile> test_parameters(const std::string& component, const std::string& parameters) {
  std::ostringstream text;
  text << "component: " << component << "\nname: " << component
       << "\nhost: localhost\nparameters:\n";
  std::istringstream lines(parameters);
  for (std::string line; std::getline(lines, line);) text << "  " << line << '\n';
  return parse_parameter_file(text.str(), component);
}

TestHost::TestHost(ComponentFactory factory, const std::string& parameters, std::uint64_t seed)
    : name_(factory.type), world_(std::make_unique<LockstepWorld>(options(seed))) {
  start(std::move(factory), parameters, seed, {});
}

TestHost::TestHost(ComponentFactory factory, const std::string& parameters,
                   std::shared_ptr<LockstepDevice> device)
    : name_(factory.type), world_(std::make_unique<LockstepWorld>(options(1))) {
  LockstepHost::Options with_device;
  with_device.device = std::move(device);
  start(std::move(factory), parameters, 1, with_device);
}

void TestHost::start(ComponentFactory factory, const std::string& parameters, std::uint64_t seed,
                     const LockstepHost::Options& host_options) {
  world_->observe_all([this](const WrittenSample& sample) {
    if (world_->participant_of(sample.writer) != name_) return;
    auto message = sample.type.deserialize(sample.cdr);
    if (!message) throw std::runtime_error(name_ + " wrote undecodable bytes to " + sample.topic);
    written_[sample.topic].push_back(std::move(message));
  });
  auto file = test_parameters(name_, parameters);
  if (!file) throw std::runtime_error(file.error());
  file->seed = seed;
  const Status status = world_->add(std::move(factory), std::move(*file), host_options);
  if (!status.ok()) throw std::runtime_error(status.error());
  world_->run_for(Duration::zero());
}

Status TestHost::try_make(ComponentFactory factory, const std::string& parameters) {
  auto file = test_parameters(factory.type, parameters);
  if (!file) return Error{file.error()};
  LockstepWorld world(options(1));
  return world.add(std::move(factory), std::move(*file));
}

const TestHost::Samples& TestHost::samples(std::string_view topic) const {
  static const Samples kNone;
  const auto found = written_.find(topic);
  return found == written_.end() ? kNone : found->second;
}

std::uint64_t TestHost::counter(const std::string& name) const {
  const auto beat = heartbeat();
  for (const auto& counter : beat.counters()) {
    if (counter.name() == name) return counter.count();
  }
  return 0;
}

}  // namespace usher::runtime
