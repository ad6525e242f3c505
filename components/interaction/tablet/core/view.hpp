#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::tablet {

enum class Page : std::uint8_t {
  kAway,      ///< the robot is not heard
  kStarting,  ///< it is, but says nothing yet
  kButtons,
  kMap,
  kJourney,
  kSearch,
};

enum class Kind : std::uint8_t { kOption = 0, kYes = 1, kNo = 2, kService = 3 };

struct Button {
  std::string id;
  std::string label;
  Kind kind = Kind::kOption;
  bool active = true;  ///< false: takes no touch yet
  bool operator==(const Button&) const = default;
};

/// Everything that a screen shows; the window only draws it.
struct View {
  Page page = Page::kStarting;
  std::uint64_t screen_id = 0;  ///< of the dialogue; 0: none
  std::string state, language;
  std::string title, text, status;
  std::vector<Button> primary, secondary, service;
  std::string query_id, query_label;  ///< the line to type into; empty: none
  std::string typed;
  bool pending = false;                              ///< a touch is on its way
  std::string pending_id;                            ///< on which button
  bool stop_offered = false, start_offered = false;  ///< by the tablet itself, at the lower left
  bool start_active = true;
  std::string stop_label, start_label;
  double time_left = -1.0;       ///< [s] until the question is given up; negative: not soon
  double time_left_share = 0.0;  ///< {0..1} of what was left when that was announced
  double progress = -1.0;        ///< {0..1}; negative: none
  std::string way_text;          ///< "35 m · 1½ min"
  std::string place;             ///< name of the location that is marked on the map
  std::string here_label;        ///< "You are here"
  bool located = false;
  geometry::Pose2 robot;  ///< in map

  bool operator==(const View&) const = default;
};

struct Place {
  std::string name, title;
  geometry::Point2 at{0, 0};  ///< [m] in map
  bool operator==(const Place&) const = default;
};

}  // namespace usher::tablet
