#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>

#include "foundation/result/result.hpp"

namespace usher {

/// The words of one line of a text that others wrote, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  /// Empty at the end of the line.
  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return word_ = {};
    const std::size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    word_ = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word_;
  }

  /// A number, `inf` and `nan` among them; false for any other word.
  template <class Number>
  bool any_number(Number& value) {
    next();
    const auto [end, error] = std::from_chars(word_.data(), word_.data() + word_.size(), value);
    return error == std::errc{} && end == word_.data() + word_.size();
  }
  /// A finite number.
  template <class Number>
  bool number(Number& value) {
    if (!any_number(value)) return false;
    if constexpr (std::is_floating_point_v<Number>) return std::isfinite(value);
    return true;
  }
  /// What the last word was, for a message.
  std::string found() const {
    return word_.empty() ? "the end of the line" : "'" + std::string(word_.substr(0, 40)) + "'";
  }

 private:
  std::string_view rest_, word_;
};

/// Calls parse(words, line number) for each line; stops at the first error that it returns.
template <class Parse>
Status for_each_line(std::string_view text, Parse parse) {
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    Status status = parse(Words(text.substr(0, end)), line);
    if (!status) return status;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return {};
}

}  // namespace usher
