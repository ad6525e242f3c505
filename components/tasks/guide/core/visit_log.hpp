#pragma once

#include <string>

#include "tasks/guide/core/visit.hpp"

namespace usher::guide {

/// The visits of a robot as CSV, a line each, the newest last: the funnel's steps, the answers,
/// what was thought of it. Beyond 512 KiB the oldest lines go.
class VisitLog {
 public:
  /// Goes on from what was kept; text that has not this header is begun anew.
  explicit VisitLog(std::string kept = {});

  /// `time` [s] since 1970 when the visit ended.
  void add(const Visit& visit, const std::string& language, double time);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace usher::guide
