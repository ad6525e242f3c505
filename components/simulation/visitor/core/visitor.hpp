#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace usher::visitor {

/// What a visitor sees of a screen.
struct Screen {
  std::uint64_t id = 0;
  std::string state;                 ///< of the dialogue
  std::vector<std::string> options;  ///< ids of its buttons
};

/// A visitor who wants to go to one place: reads each screen for a while, then answers it once.
class Visitor {
 public:
  Visitor(std::string destination, double reading_time)
      : destination_(std::move(destination)), reading_time_(reading_time) {}

  void see(const Screen& screen, double now);
  /// The option to choose now, if any. [s] of any clock that does not go back.
  std::optional<std::string> answer(double now);
  std::uint64_t screen_id() const { return screen_.id; }

  /// Walks behind the robot: from "I am ready" until the end.
  bool follows() const { return follows_; }
  bool arrived() const { return arrived_; }

 private:
  std::optional<std::string> choice() const;
  bool offers(std::string_view option) const;

  std::string destination_;
  double reading_time_;
  Screen screen_;
  double seen_at_ = 0.0;
  bool answered_ = true;
  bool follows_ = false;
  bool arrived_ = false;
};

}  // namespace usher::visitor
