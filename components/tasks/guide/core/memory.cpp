#include <charconv>
#include <map>

#include "tasks/guide/core/texts.hpp"
#include "tasks/guide/core/visit.hpp"

namespace usher::guide {

namespace {

constexpr std::string_view kHead = "usher guide 1";
constexpr std::size_t kMostRecent = 32;

bool read(std::string_view text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string to_text(const Memory& memory) {
  std::string out(kHead);
  const auto line = [&](const char* key, const std::string& value) {
    out += '\n';
    out += key;
    out += ' ';
    for (const char c : value) out += c == '\n' ? ' ' : c;
  };
  const auto number = [&](const char* key, std::uint64_t value) {
    line(key, std::to_string(value));
  };
  line("state", memory.state);
  line("language", memory.language);
  line("place", memory.place);
  number("goal", memory.goal_id);
  number("stopped", memory.stopped ? 1 : 0);
  number("stays", memory.stays ? 1 : 0);
  const Visit& visit = memory.visit;
  line("visit_place", visit.place);
  number("visit", visit.id);
  number("visit_greeted", visit.greeted ? 1 : 0);
  number("touches", visit.touches);
  number("utterances", visit.utterances);
  number("others", visit.others);
  number("ignored", visit.ignored);
  number("visit_started", visit.started);
  number("visit_arrived", visit.arrived);
  number("waits", visit.waits);
  std::string ratings;
  for (const std::uint8_t rating : visit.ratings) ratings += static_cast<char>('0' + rating);
  line("ratings", ratings);
  number("greeted", memory.funnel.greeted);
  number("engaged", memory.funnel.engaged);
  number("started", memory.funnel.started);
  number("arrived", memory.funnel.arrived);
  number("given_up", memory.funnel.given_up);
  for (const auto& place : memory.recent) line("recent", place);
  return out + "\n";
}

Result<Memory> memory_from_text(std::string_view text) {
  Memory m;
  std::uint64_t stopped = 0, stays = 0, greeted = 0;
  std::map<std::string_view, std::uint64_t*> numbers{{"goal", &m.goal_id},
                                                     {"stopped", &stopped},
                                                     {"stays", &stays},
                                                     {"visit", &m.visit.id},
                                                     {"visit_greeted", &greeted},
                                                     {"greeted", &m.funnel.greeted},
                                                     {"engaged", &m.funnel.engaged},
                                                     {"started", &m.funnel.started},
                                                     {"arrived", &m.funnel.arrived},
                                                     {"given_up", &m.funnel.given_up}};
  std::map<std::string_view, std::uint32_t*> counts{{"touches", &m.visit.touches},
                                                    {"utterances", &m.visit.utterances},
                                                    {"others", &m.visit.others},
                                                    {"ignored", &m.visit.ignored},
                                                    {"visit_started", &m.visit.started},
                                                    {"visit_arrived", &m.visit.arrived},
                                                    {"waits", &m.visit.waits}};
  std::map<std::string_view, std::string*> texts{{"state", &m.state},
                                                 {"language", &m.language},
                                                 {"place", &m.place},
                                                 {"visit_place", &m.visit.place}};
  int number = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto wrong = [&](const std::string& expected) {
      return Error{"line " + std::to_string(number) + ": expected " + expected + ", got \"" +
                   std::string(line.substr(0, 80)) + "\""};
    };
    if (++number == 1) {
      if (line != kHead) return wrong("\"" + std::string(kHead) + "\"");
      continue;
    }
    const auto space = line.find(' ');
    if (space == std::string_view::npos) return wrong("a key and a value");
    const auto key = line.substr(0, space), value = line.substr(space + 1);
    if (const auto field = texts.find(key); field != texts.end()) {
      *field->second = value;
    } else if (key == "ratings") {
      if (value.size() > kStatements || value.find_first_not_of("012345") != value.npos)
        return wrong("ratings of 0 to 5");
      for (const char c : value) m.visit.ratings.push_back(static_cast<std::uint8_t>(c - '0'));
    } else if (key == "recent") {
      if (m.recent.size() < kMostRecent) m.recent.emplace_back(value);
    } else if (const auto wide = numbers.find(key); wide != numbers.end()) {
      if (!read(value, *wide->second)) return wrong("a number");
    } else if (const auto count = counts.find(key); count != counts.end()) {
      std::uint64_t read_count = 0;
      if (!read(value, read_count) || read_count > UINT32_MAX) return wrong("a number");
      *count->second = static_cast<std::uint32_t>(read_count);
    } else {
      return wrong("a known key");
    }
  }
  if (number == 0) return Error{"line 1: expected \"" + std::string(kHead) + "\", got nothing"};
  m.stopped = stopped != 0;
  m.stays = stays != 0;
  m.visit.greeted = greeted != 0;
  return m;
}

}  // namespace usher::guide
