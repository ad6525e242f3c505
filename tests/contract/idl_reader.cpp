#include "contract/idl_reader.hpp"

#include <map>
#include <regex>
#include <sstream>

namespace usher::contract {
namespace {

/// The text without comments; "///<" ones stay. Lines stay where they are.
std::string without_comments(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 4, "///<") == 0) {
      while (i < text.size() && text[i] != '\n') result += text[i++];
    } else if (text.compare(i, 2, "//") == 0) {
      while (i < text.size() && text[i] != '\n') ++i;
    } else if (text.compare(i, 2, "/*") == 0) {
      while (i < text.size() && text.compare(i, 2, "*/") != 0) {
        if (text[i] == '\n') result += '\n';
        ++i;
      }
      i += 2;
    }
    if (i < text.size()) result += text[i];
  }
  return result;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

IdlFile read_idl(const std::string& text) {
  static const std::regex kStep(
      R"((module\s+(\w+)\s*\{)|(struct\s+(\w+)\s*\{)|(const\s+\w+\s+(\w+)\s*=\s*([^;]+);)|(\};))"
      R"(|((?:@\w+\([^)]*\)\s*)?([\w:]+(?:<[\w:, <>]+>)?)\s+(\w+)\s*(\[\d+\])?\s*;[ \t]*(?:///<([^\n]*))?))");
  const std::string source = without_comments(text);
  IdlFile file;
  std::vector<std::string> modules;
  bool in_struct = false;
  for (auto step = std::sregex_iterator(source.begin(), source.end(), kStep);
       step != std::sregex_iterator(); ++step) {
    const auto& match = *step;
    const auto line =
        static_cast<int>(std::count(source.begin(), source.begin() + match.position(), '\n')) + 1;
    if (match[1].matched) {
      modules.push_back(match[2]);
    } else if (match[3].matched) {
      file.structs.push_back({modules.empty() ? "" : modules.front(), match[4], {}});
      in_struct = true;
    } else if (match[5].matched) {
      file.constants.push_back({modules.back(), match[6], trimmed(match[7]), line});
    } else if (match[8].matched) {
      if (in_struct) {
        in_struct = false;
      } else if (!modules.empty()) {
        modules.pop_back();
      }
    } else if (in_struct) {
      file.structs.back().fields.push_back(
          {match[10].str() + match[12].str(), match[11], trimmed(match[13]), line});
    }
  }
  return file;
}

std::string ros_type(const std::string& idl_type) {
  static const std::map<std::string, std::string> kNames{{"double", "float64"},
                                                         {"float", "float32"},
                                                         {"boolean", "bool"},
                                                         {"octet", "uint8"},
                                                         {"byte", "uint8"}};
  static const std::regex kSequence(R"(sequence<\s*([\w:]+)\s*>)"), kArray(R"(([\w:/]+)(\[\d*\]))");
  std::smatch match;
  if (std::regex_match(idl_type, match, kSequence)) return ros_type(match[1]) + "[]";
  if (std::regex_match(idl_type, match, kArray)) return ros_type(match[1]) + match[2].str();
  const auto name = kNames.find(idl_type);
  if (name != kNames.end()) return name->second;
  return std::regex_replace(idl_type, std::regex("::msg::"), "/");
}

std::string comment_breach(const std::string& comment) {
  static const std::regex kForm(
      R"(\[[^\]]+\](?: or \[[^\]]+\])? \([^)]+\) \{.+\} (?:[A-Z]|[a-z]+_[a-z_]+ |[xyz] ).*\.)");
  if (comment.empty()) return "says nothing: ///< [unit] (frame) {range, special values} Sentence.";
  if (!std::regex_match(comment, kForm)) {
    return "must say [unit] (frame) {range, special values} Sentence. and says: " + comment;
  }
  return {};
}

}  // namespace usher::contract
