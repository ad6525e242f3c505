#include "drivers/urg04lx/core/scip.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "foundation/geometry/angle.hpp"

namespace usher::urg04lx {

namespace {

constexpr std::size_t kRangeCharacters = 3;

}  // namespace

char checksum(std::string_view line) {
  unsigned sum = 0;
  for (const char c : line) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3F) + 0x30);
}

std::optional<std::uint32_t> decode(std::string_view characters) {
  std::uint32_t value = 0;
  for (const char c : characters) {
    const auto bits = static_cast<unsigned>(static_cast<unsigned char>(c)) - 0x30U;
    if (bits > 0x3FU) return std::nullopt;
    value = value << 6 | bits;
  }
  return value;
}

void Reader::reset() { text_.clear(); }

bool Reader::push(char c) {
  if (c == '\r') return false;
  if (text_.empty() && c == '\n') return false;  // nothing before it
  if (text_.size() >= kMaxAnswer) {
    ++damaged_;
    text_.clear();
  }
  text_.push_back(c);
  return text_.ends_with("\n\n");
}

std::optional<Answer> Reader::split() {
  lines_.clear();
  std::string_view rest(text_);
  for (std::size_t end; (end = rest.find('\n')) != 0 && end != std::string_view::npos;) {
    lines_.push_back(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  if (lines_.size() < 2) {
    ++damaged_;
    return std::nullopt;
  }
  // SCIP 1.1 answers its last command without checksums.
  if (lines_[1] == "0") return Answer{lines_[0], lines_[1], {}};
  for (std::size_t i = 1; i < lines_.size(); ++i) {
    std::string_view& line = lines_[i];
    const char sum = line.back();
    line.remove_suffix(1);
    if (checksum(line) == sum) continue;
    // The semicolon that ends a line of text is not summed.
    if (line.ends_with(';')) line.remove_suffix(1);
    if (checksum(line) != sum) {
      ++damaged_;
      return std::nullopt;
    }
  }
  return Answer{lines_[0], lines_[1], {lines_.data() + 2, lines_.size() - 2}};
}

std::optional<Specification> parse_specification(const Answer& answer) {
  Specification s;
  struct Field {
    std::string_view name;
    int* value;
    bool found = false;
  };
  Field fields[] = {{"DMIN:", &s.shortest},        {"DMAX:", &s.longest},
                    {"ARES:", &s.steps_per_turn},  {"AMIN:", &s.first_step},
                    {"AMAX:", &s.last_step},       {"AFRT:", &s.front_step},
                    {"SCAN:", &s.turns_per_minute}};
  for (const std::string_view line : answer.data) {
    for (Field& field : fields) {
      if (!line.starts_with(field.name)) continue;
      const auto* begin = line.data() + field.name.size();
      field.found =
          std::from_chars(begin, line.data() + line.size(), *field.value).ec == std::errc();
    }
  }
  const bool all = std::all_of(std::begin(fields), std::end(fields),
                               [](const Field& field) { return field.found; });
  const bool sound = s.shortest >= 0 && s.longest > s.shortest && s.longest < 262144 &&
                     s.steps_per_turn >= 16 && s.steps_per_turn <= 8192 && s.first_step >= 0 &&
                     s.last_step > s.first_step && s.last_step < s.steps_per_turn &&
                     s.front_step >= 0 && s.front_step < s.steps_per_turn &&
                     s.turns_per_minute >= 60 && s.turns_per_minute <= 12000;
  if (!all || !sound) return std::nullopt;
  return s;
}

bool parse_scan(const Answer& answer, const Specification& s, Scan& scan, std::uint32_t& counter) {
  if (answer.data.empty() || answer.data[0].size() != 4) return false;
  const auto time = decode(answer.data[0]);
  if (!time) return false;
  counter = *time;
  const auto steps = static_cast<std::size_t>(s.last_step - s.first_step + 1);
  scan.ranges.clear();
  std::array<char, kRangeCharacters> number{};
  std::size_t filled = 0;  // a number may go on in the next line
  for (const std::string_view line : answer.data.subspan(1)) {
    for (const char c : line) {
      number[filled++] = c;
      if (filled < number.size()) continue;
      filled = 0;
      const auto value = decode({number.data(), number.size()});
      if (!value || scan.ranges.size() == steps) return false;
      const auto millimeters = static_cast<int>(*value);
      scan.ranges.push_back(millimeters == 0 || millimeters > s.longest
                                ? std::numeric_limits<float>::infinity()
                            : millimeters < s.shortest ? std::numeric_limits<float>::quiet_NaN()
                                                       : 1e-3F * static_cast<float>(millimeters));
    }
  }
  if (filled != 0 || scan.ranges.size() != steps) return false;
  scan.angle_increment = 2.0 * geometry::kPi / s.steps_per_turn;
  scan.angle_min = (s.first_step - s.front_step) * scan.angle_increment;
  scan.scan_time = 60.0 / s.turns_per_minute;
  scan.time_increment = scan.scan_time / s.steps_per_turn;
  return true;
}

}  // namespace usher::urg04lx
