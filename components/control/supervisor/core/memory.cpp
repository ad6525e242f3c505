#include "control/supervisor/core/memory.hpp"

#include <charconv>
#include <optional>
#include <string_view>

namespace usher::supervisor {

namespace {

constexpr std::string_view kHeader = "usher supervisor memory 1";

std::string on_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (c == '\t' || c == '\n') c = ' ';
  }
  return line;
}

/// Cuts the text up to the separator from the front.
std::optional<std::string_view> take(std::string_view& rest, char separator) {
  const std::size_t end = rest.find(separator);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return field;
}

template <class Number>
bool read(std::optional<std::string_view> field, Number& number) {
  if (!field) return false;
  const auto [end, error] = std::from_chars(field->data(), field->data() + field->size(), number);
  return error == std::errc() && end == field->data() + field->size();
}

}  // namespace

std::string to_text(const Memory& memory) {
  std::string text = std::string(kHeader) + "\nepoch\t" + std::to_string(memory.epoch) + "\n";
  if (memory.manual) text += "manual\ton\n";
  for (const std::string& client : memory.stopped_by) {
    text += "stop\t" + on_one_line(client) + "\n";
  }
  for (const Fault& fault : memory.latched) {
    text += "fault\t" + std::to_string(fault.id) + "\t" + std::to_string(fault.at.count()) + "\t" +
            std::to_string(static_cast<int>(fault.cause)) + "\t" + on_one_line(fault.component) +
            "\t" + on_one_line(fault.detail) + "\n";
  }
  return text;
}

Result<Memory> memory_from_text(std::span<const std::uint8_t> bytes) {
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto refuse = [](int line, const char* expected) {
    return Error{"supervisor memory, line " + std::to_string(line) + ": expected " + expected};
  };
  if (take(rest, '\n') != kHeader) return refuse(1, "'usher supervisor memory 1'");
  Memory memory;
  if (take(rest, '\t') != "epoch" || !read(take(rest, '\n'), memory.epoch)) {
    return refuse(2, "epoch and its number");
  }
  for (int line = 3; !rest.empty(); ++line) {
    const auto kind = take(rest, '\t');
    if (kind == "manual") {
      if (take(rest, '\n') != "on") return refuse(line, "manual and on");
      memory.manual = true;
      continue;
    }
    if (kind == "stop") {
      const auto client = take(rest, '\n');
      if (!client || memory.stopped_by.size() >= kMostStops) {
        return refuse(line, "stop and a client, at most 32 times");
      }
      memory.stopped_by.emplace_back(*client);
      continue;
    }
    Fault fault;
    std::int64_t at = 0;
    int cause = 0;
    const bool numbers = kind == "fault" && read(take(rest, '\t'), fault.id) &&
                         read(take(rest, '\t'), at) && read(take(rest, '\t'), cause);
    const auto component = numbers ? take(rest, '\t') : std::nullopt;
    const auto detail = component ? take(rest, '\n') : std::nullopt;
    const auto last = static_cast<int>(Cause::kMovesWhileStopped);
    if (!detail || cause < 0 || cause > last || !latches(static_cast<Cause>(cause))) {
      return refuse(line, "manual, stop, or fault, id, time, latching cause, component and detail");
    }
    if (memory.latched.size() >= FaultLog::kCapacity) return refuse(line, "at most 64 faults");
    fault.at = Time(at);
    fault.cause = static_cast<Cause>(cause);
    fault.component = *component;
    fault.detail = *detail;
    memory.latched.push_back(std::move(fault));
  }
  return memory;
}

}  // namespace usher::supervisor
