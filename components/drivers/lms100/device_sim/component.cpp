#include "drivers/lms100/device_sim/component.hpp"

#include "drivers/lms100/shell/model.hpp"

namespace usher::lms100 {

Lms100SimComponent::Lms100SimComponent(runtime::Host& host) : scanner_(host, kModel) {}

}  // namespace usher::lms100
