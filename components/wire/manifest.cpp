#include "wire/manifest.hpp"

namespace usher::wire {

std::vector<runtime::Record> read_manifest(runtime::Host& host) {
  using runtime::ParameterKind;
  return host.parameters().records(
      "manifest.components",
      {{"name", ParameterKind::kText, "-", {}, "Name in the manifest."},
       {"type", ParameterKind::kText, "-", {}, "Its type."},
       {"host", ParameterKind::kText, "-", {}, "Where it runs."},
       {"criticality", ParameterKind::kText, "-", {}, "stop, degrade or notify."},
       {"timeout", ParameterKind::kNumber, "s", {0.05, 60}, "Silence that counts as loss."}},
      "Every component of the manifest, from the launcher.");
}

}  // namespace usher::wire
