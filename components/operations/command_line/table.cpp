#include "operations/command_line/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace usher::operations {

namespace {

/// Terminal columns, not bytes: continuation bytes of UTF-8 do not count.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

bool is_number(const std::string& text) {
  return text.empty() || text == "-" ||
         text.find_first_not_of("0123456789.+-e%/ ") == std::string::npos;
}

}  // namespace

std::vector<std::string> Table::render(const std::string& separator) const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 0);
  std::vector<bool> numeric(columns, true);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (std::size_t c = 0; c < columns && c < rows_[r].size(); ++c) {
      widths[c] = std::max(widths[c], width_of(rows_[r][c]));
      if (r > 0 && !is_number(rows_[r][c])) numeric[c] = false;
    }
  }
  std::vector<std::string> lines;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string cell = c < row.size() ? row[c] : "";
      const std::string gap(widths[c] - width_of(cell), ' ');
      if (c > 0) line += separator;
      line += numeric[c] ? gap + cell : cell + gap;
    }
    lines.push_back(line);
  }
  return lines;
}

std::string Table::text() const {
  std::string out;
  for (auto& line : render("  ")) {
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string Table::markdown() const {
  const auto lines = render(" | ");
  std::string out = "| " + lines.front() + " |\n|";
  for (std::size_t c = 0; c < rows_.front().size(); ++c) out += "---|";
  out += "\n";
  for (std::size_t i = 1; i < lines.size(); ++i) out += "| " + lines[i] + " |\n";
  return out;
}

std::string format(const char* pattern, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), pattern, value);
  return buffer;
}

std::string figure(const char* pattern, double value) {
  return std::isfinite(value) ? format(pattern, value) : "-";
}

}  // namespace usher::operations
