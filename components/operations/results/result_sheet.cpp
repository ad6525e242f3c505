#include "operations/results/result_sheet.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include "operations/command_line/table.hpp"

namespace usher::operations {

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char buffer[8];
      std::snprintf(buffer, sizeof(buffer), "\\u%04x", static_cast<unsigned>(c));
      out += buffer;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char buffer[40];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(buffer, sizeof(buffer), "%.*g", digits, value);
    if (std::strtod(buffer, nullptr) == value) break;
  }
  return buffer;
}

template <class Map, class Value>
std::string object(const Map& map, const Value& value_of) {
  std::string out = "{";
  for (const auto& [key, value] : map)
    out += (out.size() > 1 ? ", " : "") + quoted(key) + ": " + number(value_of(value));
  return out + "}";
}

/// Adds the metrics that are true or false to an object of numbers.
std::string with_flags(std::string object, const std::map<std::string, bool>& flags) {
  object.pop_back();
  for (const auto& [key, flag] : flags) {
    object += (object.size() > 1 ? ", " : "") + quoted(key) + ": " + (flag ? "true" : "false");
  }
  return object + "}";
}

bool holds(const ResultSheet::Target& target, double value) {
  return target.bound == Bound::kAtMost ? value <= target.value : value >= target.value;
}

}  // namespace

bool ResultSheet::pass() const {
  for (const auto& [key, flag] : flags) {
    if (!flag) return false;
  }
  for (const auto& [key, target] : targets) {
    const auto metric = metrics.find(key);
    if (metric == metrics.end() || !holds(target, metric->second)) return false;
  }
  return true;
}

std::string ResultSheet::json() const {
  const auto plain = [](double value) { return value; };
  return "{\"name\": " + quoted(name) + ", \"input\": " + quoted(input) +
         ",\n \"metrics\": " + with_flags(object(metrics, plain), flags) +
         ",\n \"published\": " + object(published, plain) +
         ",\n \"targets\": " + object(targets, [](const Target& target) { return target.value; }) +
         ",\n \"pass\": " + (pass() ? "true" : "false") + "}\n";
}

std::string ResultSheet::markdown() const {
  Table table({"figure", "found", "target", "published"});
  for (const auto& [key, flag] : flags) table.add({key, flag ? "yes" : "no", "yes", ""});
  for (const auto& [key, value] : metrics) {
    const auto target = targets.find(key);
    const auto other = published.find(key);
    std::string wanted;
    if (target != targets.end()) {
      wanted = (target->second.bound == Bound::kAtMost ? "at most " : "at least ") +
               format("%.4g", target->second.value) +
               (holds(target->second, value) ? "" : " (missed)");
    }
    table.add({key, format("%.4g", value), wanted,
               other == published.end() ? "" : format("%.4g", other->second)});
  }
  return table.markdown();
}

Status write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) return Error{"cannot write " + path};
  return {};
}

}  // namespace usher::operations
