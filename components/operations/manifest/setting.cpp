#include "operations/manifest/setting.hpp"

namespace usher::operations {

std::optional<Setting> setting(const Contracts& contracts, const Deployment& deployment,
                               std::size_t index, const std::string& name) {
  const auto contract = contracts.find(deployment.manifest.components[index].type);
  if (contract == contracts.end()) return std::nullopt;
  for (const auto& parameter : contract->second.parameters) {
    if (parameter.name != name) continue;
    runtime::ParameterValue value{name, parameter.fallback, ""};
    for (const auto& given : deployment.files[index].values) {
      if (given.name == name) value = given;
    }
    if (auto read = runtime::interpret(parameter, value))
      return Setting{std::move(read).value(), value.origin};
  }
  return std::nullopt;
}

}  // namespace usher::operations
