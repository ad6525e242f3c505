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
  std::string language;              ///< of its texts
  std::string place;                 ///< that it is about; empty: none
  std::vector<std::string> options;  ///< ids of its buttons
  std::string text_option;           ///< id of the line to type into; empty: none
  double time_left = -1.0;           ///< [s] until the question is given up; negative: not soon
  std::optional<bool> calls;         ///< it calls him, or has said something else; nothing: a sound
};

/// How a visitor behaves. Times in seconds, those on the way from the departure on.
struct Character {
  std::string destination = "lounge";
  std::string language = "en";
  double reading_time = 1.5;        ///< of each screen
  bool looks_at_map = false;        ///< wants to see our location first
  bool asks_where = false;          ///< and where the destination is
  bool waits_for_greeting = false;  ///< touches nothing before
  bool types = false;               ///< searches by name instead of turning pages
  std::string returns_to;           ///< a second place after the first; empty: none
  double stops_at = -1.0;           ///< stops the robot; negative: never
  double stops_for = 5.0;
  double cancels_at = -1.0;
  double dawdles_at = -1.0;    ///< walks slowly from then on
  double ties_lace_at = -1.0;  ///< stands
  double ties_lace_for = 12.0;
  double walks_away_at = -1.0;
  double walks_away_for = -1.0;  ///< then follows again; negative: never comes back
  double blocks_at = -1.0;       ///< steps before the robot and stands there
  double blocks_for = 10.0;
  double crowd_at = -1.0;  ///< others gather round the robot
  double crowd_for = 10.0;
  bool leads = false;          ///< wants the robot to follow instead
  std::string rates = "none";  ///< statements of the questionnaire: none, some, all
  std::string gives_up_in;     ///< answers nothing more from this state of the dialogue on
};

struct Choice {
  std::string option;
  std::string text;  ///< typed, for a line
};

enum class Walk : std::uint8_t { kStand, kFollow, kDawdle, kAway, kBlock, kLead, kReturn };

/// A visitor who wants to go to a place: reads each screen for a while, then answers it once.
/// Times of calls are seconds on any clock that does not go back.
class Visitor {
 public:
  explicit Visitor(Character character) : character_(std::move(character)) {}

  void see(const Screen& screen, double now);
  /// What to choose now, if anything.
  std::optional<Choice> answer(double now);
  std::uint64_t screen_id() const { return screen_.id; }
  const Character& character() const { return character_; }

  /// Stands until the first departure, then follows until the end, unless its character is another.
  /// Who leads comes back when it is called.
  Walk walk(double now) const;
  bool arrived() const { return arrivals_ > 0; }
  /// Whether others stand round the robot now.
  bool crowded(double now) const;
  /// It has led the robot to where it wanted to; it says so when the robot has come up.
  void led(double now) { led_at_ = led_at_ ? led_at_ : now; }

 private:
  std::optional<Choice> choice(double now);
  std::optional<Choice> choose_place();
  std::optional<Choice> on_the_way(double now);
  std::optional<Choice> rate();
  std::optional<Choice> turn_back(std::string_view option);
  bool offers(std::string_view option) const;
  std::optional<Choice> press(std::string_view option) const;
  const std::string& wanted() const;
  /// It was understood wrongly, and the robot is about to go elsewhere.
  bool wrong_place() const { return !screen_.place.empty() && screen_.place != wanted(); }
  /// It has been everywhere that it wanted to.
  bool satisfied() const { return arrivals_ >= (character_.returns_to.empty() ? 1 : 2); }
  bool misses_map() const { return character_.looks_at_map && !saw_map_ && arrivals_ == 0; }

  Character character_;
  Screen screen_;
  double seen_at_ = 0.0;
  bool answered_ = true;
  bool typed_ = false;
  bool gave_up_ = false;
  std::optional<double> departed_at_, stopped_at_;
  bool asked_where_ = false, stopped_ = false, ended_ = false;
  bool saw_map_ = false;
  bool gave_in_ = false;  ///< it does not want to go there any more
  bool misled_ = false;   ///< it was understood wrongly, and begins anew
  std::optional<double> led_at_, awaited_at_, called_at_;
  int arrivals_ = 0, errors_ = 0, rated_ = 0, languages_asked_ = 0, begun_again_ = 0;
};

}  // namespace usher::visitor
