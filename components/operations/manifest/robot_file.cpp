#include "operations/manifest/robot_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "operations/manifest/tree.hpp"

namespace usher::operations {

namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::size_t indent_of(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

bool says_something(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first != std::string::npos && line[first] != '#';
}

bool has_key(const std::string& line, const std::string& key) {
  return line.compare(indent_of(line), key.size() + 1, key + ":") == 0;
}

/// Puts a value in a line `  key: value   # why`; the comment stays in its column where it can.
void replace_value(std::string& line, const std::string& key, const std::string& value) {
  const std::size_t comment = std::min(line.find(" #"), line.size());
  const std::size_t column = std::min(line.find('#', comment), line.size());
  std::string changed = line.substr(0, indent_of(line)) + key + ": " + value;
  if (column < line.size()) {
    changed.resize(std::max(changed.size() + 1, column), ' ');
    changed += line.substr(column);
  }
  line = std::move(changed);
}

Status verify(const std::string& text, const std::string& where, const std::string& section,
              const FileValues& values) {
  const auto tree = parse_tree(text, where);
  if (!tree) return Error{tree.error()};
  const Tree* block = tree->find(section);
  for (const auto& [key, value] : values) {
    const Tree* found = block != nullptr ? block->find(key) : nullptr;
    if (found == nullptr || found->scalar != value) {
      std::string reason = "'" + key;
      reason += "' cannot be set in '" + section;
      reason += "' of " + where + ": write a key a line";
      return Error{reason};
    }
  }
  return {};
}

}  // namespace

Result<std::string> with_values(const std::string& text, const std::string& where,
                                const std::string& section, const FileValues& values) {
  if (const auto tree = parse_tree(text, where); !tree) return Error{tree.error()};
  Lines lines = lines_of(text);
  auto head = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) {
    return indent_of(line) == 0 && has_key(line, section);
  });
  if (head == lines.end()) {
    lines.emplace_back();
    lines.push_back(section + ":");
    head = lines.end() - 1;
  }
  const auto begin = static_cast<std::size_t>(head - lines.begin()) + 1;
  std::size_t end = begin, indent = 2;  // end: after the section's last entry
  for (std::size_t i = begin; i < lines.size(); ++i) {
    if (!says_something(lines[i])) continue;
    if (indent_of(lines[i]) == 0) break;
    if (end == begin) indent = indent_of(lines[i]);
    end = i + 1;
  }
  for (const auto& [key, value] : values) {
    const auto last = lines.begin() + static_cast<std::ptrdiff_t>(end);
    const auto line = std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(begin), last,
                                   [&, &key = key](const std::string& one) {
                                     return indent_of(one) == indent && has_key(one, key);
                                   });
    if (line != last) {
      replace_value(*line, key, value);
    } else {
      std::string added(indent, ' ');
      added += key;
      added += ": ";
      lines.insert(last, added += value);
      ++end;
    }
  }
  std::string changed;
  for (const std::string& line : lines) changed += line + "\n";
  if (auto status = verify(changed, where, section, values); !status) return Error{status.error()};
  return changed;
}

Status set_values(const std::string& path, const std::string& section, const FileValues& values) {
  std::error_code error;
  const fs::path file = fs::canonical(path, error);
  if (error) return Error{"cannot read " + path + ": " + error.message()};
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) return Error{"cannot read " + path};
  const auto changed = with_values(text, path, section, values);
  if (!changed) return Error{changed.error()};
  const fs::path beside = file.string() + ".new";
  std::ofstream out(beside, std::ios::binary | std::ios::trunc);
  out << *changed;
  out.close();
  if (out) fs::permissions(beside, fs::status(file).permissions(), error);
  if (out && !error) fs::rename(beside, file, error);
  if (out && !error) return {};
  std::error_code ignored;
  fs::remove(beside, ignored);
  return Error{"cannot write " + path + (error ? ": " + error.message() : "")};
}

}  // namespace usher::operations
