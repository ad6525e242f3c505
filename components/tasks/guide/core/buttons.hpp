#pragma once

#include <string>
#include <string_view>

namespace usher::guide::button {

// Ids of buttons, the same in every language.
inline constexpr const char* kYes = "yes";
inline constexpr const char* kNo = "no";
inline constexpr const char* kStart = "start";
inline constexpr const char* kStop = "stop";
inline constexpr const char* kContinue = "continue";
inline constexpr const char* kCancel = "cancel";
inline constexpr const char* kMore = "more";
inline constexpr const char* kDone = "done";
inline constexpr const char* kRepeat = "repeat";
inline constexpr const char* kStay = "stay";
inline constexpr const char* kSearch = "search";
inline constexpr const char* kBack = "back";
inline constexpr const char* kWhereIs = "where_is";
inline constexpr const char* kGuideMe = "guide_me";
inline constexpr const char* kLanguages = "languages";
inline constexpr const char* kAgain = "again";
inline constexpr const char* kFollowMe = "follow_me";
inline constexpr const char* kSkip = "skip";
inline constexpr const char* kQuery = "query";  ///< the line to type into

/// How far the visitor agrees: 1 strongly disagrees .. 5 strongly agrees.
inline std::string rating(int agreement) { return "rating:" + std::to_string(agreement); }
inline std::string language(const std::string& tag) { return "language:" + tag; }

}  // namespace usher::guide::button

namespace usher::guide {

/// Whether a location must not have this name.
inline bool is_button(std::string_view name) {
  using namespace button;
  for (const char* id :
       {kYes, kNo, kStart, kStop, kContinue, kCancel, kMore, kDone, kRepeat, kStay, kSearch, kBack,
        kWhereIs, kGuideMe, kLanguages, kAgain, kFollowMe, kSkip, kQuery}) {
    if (name == id) return true;
  }
  return name.starts_with("language:") || name.starts_with("rating:");
}

}  // namespace usher::guide
