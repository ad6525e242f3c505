#include "interaction/finger/core/tap.hpp"

#include <charconv>
#include <optional>
#include <string_view>

namespace usher::finger {

namespace {

constexpr std::string_view kButton = " button ";
constexpr std::string_view kKey = " key ";
constexpr std::size_t kLongestLine = kLongestTarget + 32;

std::optional<Tap> parse(std::string_view line) {
  Tap tap;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), tap.screen_id);
  if (error != std::errc{}) return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  tap.key = line.starts_with(kKey);
  if (!tap.key && !line.starts_with(kButton)) return std::nullopt;
  line.remove_prefix(tap.key ? kKey.size() : kButton.size());
  if (line.empty() || line.size() > kLongestTarget) return std::nullopt;
  tap.target = line;
  return tap;
}

}  // namespace

std::string to_line(const Tap& tap) {
  std::string line = std::to_string(tap.screen_id);
  line += tap.key ? kKey : kButton;
  line += tap.target;
  line += '\n';
  return line;
}

std::vector<Tap> Lines::take(std::span<const std::uint8_t> bytes) {
  std::vector<Tap> taps;
  for (const std::uint8_t byte : bytes) {
    if (byte != '\n') {
      if (line_.size() <= kLongestLine)
        line_ += static_cast<char>(byte);  // longer is refused anyway
      continue;
    }
    auto tap = line_.size() > kLongestLine ? std::nullopt : parse(line_);
    if (tap) {
      taps.push_back(std::move(*tap));
    } else {
      ++rejected_;
    }
    line_.clear();
  }
  return taps;
}

}  // namespace usher::finger
