#include "simulation/visitor/core/visitor.hpp"

#include <algorithm>

namespace usher::visitor {

void Visitor::see(const Screen& screen, double now) {
  const bool another = screen.id != screen_.id;
  screen_ = screen;
  if (!another) return;
  seen_at_ = now;
  answered_ = false;
  if (screen.state == "guide_active") follows_ = true;
  if (screen.state == "guide_success") arrived_ = true;
  if (screen.state == "end" || screen.state == "guide_error") follows_ = false;
}

std::optional<std::string> Visitor::answer(double now) {
  if (answered_ || now < seen_at_ + reading_time_) return std::nullopt;
  const auto chosen = choice();
  if (chosen) answered_ = true;
  return chosen;
}

bool Visitor::offers(std::string_view option) const {
  return std::find(screen_.options.begin(), screen_.options.end(), option) != screen_.options.end();
}

std::optional<std::string> Visitor::choice() const {
  if (arrived_)
    return offers("no") ? std::optional<std::string>("no")
                        : std::nullopt;  // nothing else, thank you
  if (offers(destination_)) return destination_;
  for (const char* option : {"start", "continue", "yes", "more"}) {
    if (offers(option)) return option;
  }
  return std::nullopt;
}

}  // namespace usher::visitor
