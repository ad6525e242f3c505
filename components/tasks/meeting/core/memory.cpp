#include "tasks/meeting/core/memory.hpp"

#include <charconv>
#include <utility>

namespace usher::meeting {

namespace {

/// One line after the other, each `key value`.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  Result<std::string> text(std::string_view key) {
    const auto end = text_.find('\n');
    const std::string_view line = text_.substr(0, end);
    if (end == std::string_view::npos || !line.starts_with(key) || line.size() <= key.size() ||
        line[key.size()] != ' ')
      return Error{"expected '" + std::string(key) + " ...', got '" + std::string(line) + "'"};
    text_.remove_prefix(end + 1);
    return std::string(line.substr(key.size() + 1));
  }
  template <class Number>
  Status number(std::string_view key, Number& value) {
    const auto word = text(key);
    if (!word) return Error{word.error()};
    const char* end = word->data() + word->size();
    const auto [rest, error] = std::from_chars(word->data(), end, value);
    if (error != std::errc() || rest != end)
      return Error{"expected a number after '" + std::string(key) + "', got '" + *word + "'"};
    return {};
  }
  bool over() const { return text_.empty(); }

 private:
  std::string_view text_;
};

}  // namespace

std::string to_text(const Report& report) {
  return "id " + std::to_string(report.id) + "\nclient " + report.client + "\nroom " + report.room +
         "\nwanted " + std::to_string(report.wanted) + "\nbrought " +
         std::to_string(report.brought) + "\n";
}

Result<Report> report_from_text(std::string_view text) {
  Report report;
  Lines lines(text);
  if (Status read = lines.number("id", report.id); !read) return Error{read.error()};
  auto client = lines.text("client");
  if (!client) return Error{client.error()};
  report.client = std::move(client).value();
  auto room = lines.text("room");
  if (!room) return Error{room.error()};
  report.room = std::move(room).value();
  if (Status read = lines.number("wanted", report.wanted); !read) return Error{read.error()};
  if (Status read = lines.number("brought", report.brought); !read) return Error{read.error()};
  if (!lines.over()) return Error{"expected an end after 'brought'"};
  return report;
}

}  // namespace usher::meeting
