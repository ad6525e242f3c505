// to_yaml(): any message of the IDL as text, for people and tools.
#include <array>
#include <cmath>
#include <cstdio>

#include "runtime/dds/cdr_cursor.hpp"
#include "runtime/dds/message_layout.hpp"

namespace usher::runtime {
namespace {

template <class... Arguments>
std::string formatted(const char* format, Arguments... arguments) {
  std::array<char, 40> text{};
  const int size = std::snprintf(text.data(), text.size(), format, arguments...);
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string real(double value, int digits) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value) && value > 0.0) return ".inf";
  if (std::isinf(value)) return "-.inf";
  return formatted("%.*g", digits, value);
}

std::string scalar(FieldKind kind, const std::uint8_t* bytes, const CdrCursor& cursor) {
  switch (kind) {
    case FieldKind::kBool:
      return bytes[0] != 0 ? "true" : "false";
    case FieldKind::kInt8:
      return std::to_string(static_cast<std::int8_t>(bytes[0]));
    case FieldKind::kUint8:
      return std::to_string(bytes[0]);
    case FieldKind::kInt16:
      return std::to_string(cursor.read<std::int16_t>(bytes));
    case FieldKind::kUint16:
      return std::to_string(cursor.read<std::uint16_t>(bytes));
    case FieldKind::kInt32:
      return std::to_string(cursor.read<std::int32_t>(bytes));
    case FieldKind::kUint32:
      return std::to_string(cursor.read<std::uint32_t>(bytes));
    case FieldKind::kInt64:
      return std::to_string(cursor.read<std::int64_t>(bytes));
    case FieldKind::kUint64:
      return std::to_string(cursor.read<std::uint64_t>(bytes));
    case FieldKind::kFloat:
      return real(cursor.read<float>(bytes), 7);
    case FieldKind::kDouble:
      return real(cursor.read<double>(bytes), 15);
    case FieldKind::kString:
    case FieldKind::kStruct:
      break;
  }
  return {};
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += formatted("\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      result += c;
    }
  }
  return result + '"';
}

class Printer {
 public:
  Printer(CdrCursor cursor, std::size_t items_max) : cursor_(cursor), items_max_(items_max) {}

  /// `first_prefix` stands before the first member ("- " of a list), the others are indented alike.
  void structure(const MessageLayout& layout, const std::string& first_prefix,
                 const std::string& prefix, bool show) {
    bool first = true;
    for (const FieldLayout& field : layout.fields) {
      if (!cursor_.ok()) return;
      member(field, first ? first_prefix : prefix, prefix, show);
      first = false;
    }
  }

  std::string text;
  bool ok() const { return cursor_.ok(); }

 private:
  void member(const FieldLayout& field, const std::string& before, const std::string& prefix,
              bool show) {
    const std::uint32_t count = field.sequence ? cursor_.length() : field.count;
    if (!cursor_.ok()) return;
    if (show) text += before + field.name + ':';
    const bool many = field.sequence || field.array;
    if (field.kind == FieldKind::kStruct) {
      if (show) text += many && count == 0 ? " []\n" : "\n";
      const std::string deeper = prefix + "  ";
      for (std::uint32_t i = 0; i < count && cursor_.ok(); ++i) {
        structure(*field.type, many ? prefix + "- " : deeper, deeper,
                  show && (!many || i < items_max_));
      }
      if (show && many && count > items_max_) {
        text += prefix + "# " + std::to_string(count - items_max_) + " more\n";
      }
      return;
    }
    const std::string line = values(field, count, many);
    if (show) text += ' ' + line + '\n';
  }

  std::string values(const FieldLayout& field, std::uint32_t count, bool many) {
    std::string line = many ? "[" : "";
    const std::size_t size = wire_size(field.kind);
    const std::uint8_t* first = size > 0 && count > 0 ? cursor_.scalars(size, count) : nullptr;
    for (std::uint32_t i = 0; i < count && cursor_.ok(); ++i) {
      if (size > 0 && i >= items_max_ && many) break;
      const std::string value =
          size > 0 ? scalar(field.kind, first + i * size, cursor_) : quoted(cursor_.string());
      if (!many || i < items_max_) line += (i > 0 ? ", " : "") + value;
    }
    if (!many) return line;
    line += ']';
    return count > items_max_ ? line + "  # first of " + std::to_string(count) : line;
  }

  CdrCursor cursor_;
  std::size_t items_max_;
};

}  // namespace

std::string to_yaml(const MessageLayout& layout, std::span<const std::uint8_t> cdr,
                    std::size_t items_max) {
  Printer printer(CdrCursor(cdr), items_max);
  if (printer.ok()) printer.structure(layout, "", "", true);
  if (!is_well_formed(layout, cdr)) {
    printer.text +=
        "# not a message of type " + layout.name + " (" + std::to_string(cdr.size()) + " bytes)\n";
  }
  return std::move(printer.text);
}

}  // namespace usher::runtime
