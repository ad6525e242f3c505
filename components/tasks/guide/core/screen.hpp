#pragma once

#include "tasks/service/core/screen.hpp"

namespace usher::guide {

using service::Answer;
using service::AnswerResult;
using service::Content;
using service::Follower;
using service::Human;
using service::Input;
using service::kNothing;
using service::Option;
using service::OptionKind;
using service::Panel;
using service::Screen;
using service::Tone;

}  // namespace usher::guide
