#include "tasks/guide/core/visit_log.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "tasks/guide/core/texts.hpp"

namespace usher::guide {

namespace {

constexpr std::size_t kMost = std::size_t{512} * 1024;  ///< [byte]
constexpr std::array kOutcomes{"open", "left", "ended", "arrived", "given up"};

std::string head() {
  std::string line =
      "time,visit,language,outcome,place,greeted,engaged,started,arrived,touches,utterances,"
      "seconds,"
      "waits";
  for (std::size_t i = 1; i <= kStatements; ++i) line += ",statement_" + std::to_string(i);
  return line + "\n";
}

/// Names of places come from a site's file.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

VisitLog::VisitLog(std::string kept) : text_(std::move(kept)) {
  if (!text_.starts_with(head())) text_ = head();
}

void VisitLog::add(const Visit& visit, const std::string& language, double time) {
  std::string line = std::to_string(std::llround(time)) + "," + std::to_string(visit.id) + "," +
                     language + "," + kOutcomes.at(static_cast<std::size_t>(visit.outcome)) + "," +
                     quoted(visit.place);
  const auto field = [&line](std::uint64_t value) { line += "," + std::to_string(value); };
  field(visit.greeted ? 1 : 0);
  field(visit.engaged() ? 1 : 0);
  field(visit.started);
  field(visit.arrived);
  field(visit.touches);
  field(visit.utterances);
  field(static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(visit.duration).count()));
  field(visit.waits);
  for (std::size_t i = 0; i < kStatements; ++i) {
    line += ',';
    if (i < visit.ratings.size() && visit.ratings[i] > 0) line += std::to_string(visit.ratings[i]);
  }
  text_ += line + "\n";
  while (text_.size() > kMost) {
    const auto oldest = text_.find('\n') + 1;
    text_.erase(oldest, text_.find('\n', oldest) + 1 - oldest);
  }
}

}  // namespace usher::guide
