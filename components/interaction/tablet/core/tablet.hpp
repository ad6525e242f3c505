#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "interaction/own_stop/core/visits_stop.hpp"
#include "interaction/phrases/core/phrase_file.hpp"
#include "interaction/tablet/core/view.hpp"

namespace usher::tablet {

using Time = std::chrono::nanoseconds;

/// The tablet's own texts, for what the robot cannot say; section `tablet` of config/dialogue.
enum class Text : std::size_t {
  kAway,
  kAwayText,
  kStarting,
  kStop,
  kStart,
  kHeld,
  kStopUnsure,
  kYouAreHere,
};
inline constexpr std::array<std::string_view, 8> kTextKeys{
    "away", "away_text", "starting", "stop", "start", "held", "stop_unsure", "you_are_here"};

enum class Panel : std::uint8_t { kPrimary = 0, kSecondary = 1, kService = 2 };

/// What the dialogue says, as it comes.
struct Screen {
  struct Option {
    std::string id, label;
    std::uint8_t kind = 0;   ///< as Kind
    std::uint8_t panel = 0;  ///< as Panel
    bool takes_text = false;
  };
  std::uint64_t id = 0;
  std::string state, language;
  std::uint8_t content = 0;  ///< 0 buttons, 1 map, 2 journey, 3 search
  std::string title, text, status;
  std::vector<Option> options;
  std::string place;
  double progress = -1.0;
  double eta = std::numeric_limits<double>::quiet_NaN();        ///< [s]
  double remaining = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  double time_left = std::numeric_limits<double>::quiet_NaN();  ///< [s]
};

struct Answer {
  std::uint64_t screen_id = 0;
  std::string option_id;
  std::string text;
  bool operator==(const Answer&) const = default;
};

/// What a touch asks of the others.
struct Touched {
  std::optional<Answer> answer;
  bool stop = false;  ///< the supervisor shall stop the robot, whatever the dialogue does
  bool move = false;  ///< and let it move again
};

/// The logic of the tablet: what to show, what a touch means, whose stop holds.
///
/// A stop goes to the dialogue and, so that it works when the dialogue does not, straight to the
/// supervisor. The tablet lifts its own stop when the visitor touches Start, "I am still here" or
/// Continue, when an answer, by touch or voice, sets the robot off, and when the visit ends. A
/// journey that ends while it is stopped leaves the robot stopped.
class Tablet {
 public:
  explicit Tablet(phrases::PhraseBook phrases) : phrases_(std::move(phrases)) {}

  /// How long a touched button stays so without a reply.
  static constexpr Time kPatience = std::chrono::seconds(2);
  static constexpr std::size_t kMostTyped = 40;  ///< [byte]
  /// Buttons that have just come are not touched yet: the finger was meant for those before. So
  /// long a double tap takes; reading what is new takes longer.
  static constexpr Time kSettles = std::chrono::milliseconds(400);
  /// Who is frightened taps Stop again and again, and what lets the robot move comes to where Stop
  /// was: it takes no touch until nobody has touched for so long, as long as answers may be late.
  static constexpr Time kCalms = own_stop::VisitsStop::kAnswerLate;

  /// Whether robot (supervisor) and dialogue (guide) are heard.
  void hear(bool robot, bool dialogue, Time now);
  /// Somebody is served or not, the supervisor navigates or not; whether the tablet's own stop ends
  /// with the visit. A dialogue that forgets its visit has not ended the journey.
  Touched hear_visit(bool served, bool navigates, Time now);
  void locate(const std::optional<geometry::Pose2>& pose) { pose_ = pose; }
  /// What the robot's ear has to say: a question back takes the place of the text, anything else
  /// that of the status; empty: nothing.
  void hear_speech(const std::string& hint, bool asks) {
    hint_ = hint;
    asks_ = asks;
  }
  /// A screen arrived; whether the tablet's own stop ends with it.
  Touched take(const Screen& screen, Time now);
  /// The dialogue has replied to this tablet's newest answer.
  void replied() { pending_.reset(); }

  /// A button was touched; ids that are not on the view do nothing, nor does a second touch before
  /// the reply, nor, but for a stop, one of buttons that came less than kSettles ago, nor what lets
  /// the robot move less than kCalms after a stop or a touch that followed it.
  Touched touch(const std::string& id, Time now);
  /// The line to type into has this text now.
  Touched type(const std::string& text);

  /// This tablet holds the robot; to be kept over a restart.
  bool holds() const { return hold_ != Hold::kNone; }
  /// A tablet that was restarted while it held the robot.
  void hold_again() { hold_ = Hold::kOwn; }
  /// What the supervisor says of the tablet's stop. False when it is as was known.
  bool hear_stop(bool holds, Time now);

  View view(Time now) const;

  static constexpr const char* kStop = "tablet:stop";
  static constexpr const char* kStart = "tablet:start";

 private:
  enum class Hold : std::uint8_t { kNone, kOwn, kDialogue, kDialogueTookOver };
  struct Pending {
    std::string id;
    Time since{};
  };
  std::string say(Text text) const;
  bool offers(std::string_view id) const;
  bool shows_dialogue() const { return robot_heard_ && dialogue_heard_ && screen_.id != 0; }
  bool calm(Time now) const { return now >= calm_at_; }
  Touched stop(Time now);
  Touched press(const std::string& id, Time now);
  Touched follow_hold(bool drove, Time now);
  bool lift_hold();
  void watch_buttons(Time now);
  void add_options(View& view, Time now) const;

  phrases::PhraseBook phrases_;
  Screen screen_;
  double announced_ = 0.0;  ///< [s] that were left when the end of this question was announced
  bool robot_heard_ = false, dialogue_heard_ = false;
  std::optional<geometry::Pose2> pose_;
  std::optional<Pending> pending_;
  std::string typed_, hint_;
  bool asks_ = false;
  Hold hold_ = Hold::kNone;
  own_stop::VisitsStop stop_;         ///< the visitor's newest, by this tablet
  std::vector<std::string> buttons_;  ///< ids on the view, the screen's first
  Time settled_{};                    ///< when they may be touched
  Time calm_at_{};                    ///< when the robot may be let move again
};

/// "35 m · 1½ min", rounded as the dialogue says it, of what is known; empty when nothing is.
std::string way_text(double remaining, double eta);

}  // namespace usher::tablet
