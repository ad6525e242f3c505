#include "drivers/urg04lx/device_real/component.hpp"

#include "drivers/urg04lx/shell/model.hpp"

namespace usher::urg04lx {

Urg04lxComponent::Urg04lxComponent(runtime::Host& host)
    : rejected_(host.health().counter("answers: rejected")),
      line_(host, kModel, Session(),
            {.address = "serial:///dev/ttyACM0?baud=115200",
             .text = "The scanner's line.",
             .count = [this](const Session& session) { rejected_ = session.rejected(); }}) {}

}  // namespace usher::urg04lx
