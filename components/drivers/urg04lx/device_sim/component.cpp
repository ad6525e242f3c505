#include "drivers/urg04lx/device_sim/component.hpp"

#include "drivers/urg04lx/shell/model.hpp"

namespace usher::urg04lx {

Urg04lxSimComponent::Urg04lxSimComponent(runtime::Host& host) : scanner_(host, kModel) {}

}  // namespace usher::urg04lx
