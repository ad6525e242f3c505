#pragma once

#include "foundation/imaging/appearance.hpp"
#include "usher_msgs.h"

namespace usher::wire {

usher_msgs::msg::Appearance to_message(const imaging::Appearance& appearance);
/// A color that is not finite or that cannot be is one that is not known.
imaging::Appearance from_message(const usher_msgs::msg::Appearance& message);

}  // namespace usher::wire
