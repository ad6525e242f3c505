#include "runtime/parameters/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace usher::runtime {
namespace {

/// value in SI = value * times / over
struct Unit {
  std::string_view text, si;
  double times = 1.0, over = 1.0;
};

constexpr std::array kUnits{
    Unit{"m", "m"},
    Unit{"mm", "m", 1, 1000},
    Unit{"cm", "m", 1, 100},
    Unit{"km", "m", 1000},
    Unit{"rad", "rad"},
    Unit{"deg", "rad", std::numbers::pi, 180},
    Unit{"s", "s"},
    Unit{"ms", "s", 1, 1000},
    Unit{"us", "s", 1, 1000000},
    Unit{"min", "s", 60},
    Unit{"Hz", "Hz"},
    Unit{"m/s", "m/s"},
    Unit{"rad/s", "rad/s"},
    Unit{"deg/s", "rad/s", std::numbers::pi, 180},
    Unit{"m/s2", "m/s2"},
    Unit{"rad/s2", "rad/s2"},
    Unit{"deg/s2", "rad/s2", std::numbers::pi, 180},
    Unit{"m/s3", "m/s3"},
    Unit{"rad/s3", "rad/s3"},
    Unit{"m2", "m2"},
    Unit{"kg", "kg"},
    Unit{"V", "V"},
    Unit{"%", "%"},
    Unit{"-", "-"},
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

std::optional<double> to_si(double value, std::string_view unit, std::string_view si) {
  for (const Unit& known : kUnits) {
    if (known.text == unit && known.si == si) return value * known.times / known.over;
  }
  return std::nullopt;
}

bool is_si(std::string_view unit) { return to_si(1.0, unit, unit).has_value(); }

std::string units_of(std::string_view si) {
  std::string text;
  for (const Unit& known : kUnits) {
    if (known.si != si) continue;
    if (!text.empty()) text += ", ";
    text += known.text;
  }
  return text;
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string with_unit(double value, std::string_view si) {
  if (si == "-" || std::isinf(value)) return shortest(value);
  std::string text = shortest(value) + " " + std::string(si);
  if (si != "rad" && si != "rad/s" && si != "rad/s2") return text;
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.12g", value * 180.0 / std::numbers::pi);
  const std::string unit = "deg" + std::string(si.substr(3));
  const std::string degrees = std::string(buffer.data()) + " " + unit;
  const bool same = to_si(read_number(degrees)->value, unit, si) == value;
  return same && degrees.size() < text.size() ? degrees : text;
}

std::optional<WrittenNumber> read_number(std::string_view text) {
  text = trimmed(text);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  WrittenNumber number;
  for (const std::string_view infinite : {".inf", "inf"}) {
    if (!text.starts_with(infinite)) continue;
    number.value = std::numeric_limits<double>::infinity();
    number.unit = trimmed(text.substr(infinite.size()));
  }
  if (number.value == 0.0) {
    if (text.empty() || (text[0] != '.' && (text[0] < '0' || text[0] > '9'))) return std::nullopt;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number.value);
    if (error != std::errc{}) return std::nullopt;
    number.unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  }
  if (negative) number.value = -number.value;
  return number;
}

}  // namespace usher::runtime
