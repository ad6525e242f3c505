#include "runtime/dds/message_layout.hpp"

#include <cassert>
#include <charconv>

#include "runtime/dds/cdr_cursor.hpp"
#include "runtime/dds/idl_text.hpp"

namespace usher::runtime {

/// Recursive descent over the few productions of IDL that idl/ uses.
class IdlParser {
 public:
  explicit IdlParser(std::string_view text) : text_(text) { advance(); }

  Result<MessageLayouts> run() {
    while (error_.empty() && !token_.empty()) definition();
    if (!error_.empty()) return Error{error_};
    return std::move(result_);
  }

 private:
  void fail(const std::string& message) {
    if (error_.empty()) error_ = "IDL line " + std::to_string(taken_line_) + ": " + message;
    token_ = {};
  }
  static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '-' || c == '+';
  }
  void skip_to(std::string_view end, std::size_t after) {
    const std::size_t stop = text_.find(end, at_);
    const std::size_t next = stop == std::string_view::npos ? text_.size() : stop + after;
    for (; at_ < next; ++at_) line_ += text_[at_] == '\n' ? 1 : 0;
  }
  /// The next word ("a::b::c" is one) or sign; empty at the end.
  void advance() {
    token_ = {};
    for (; at_ < text_.size();) {
      if (text_.substr(at_, 2) == "//" || text_[at_] == '#') {
        skip_to("\n", 0);
      } else if (text_.substr(at_, 2) == "/*") {
        skip_to("*/", 2);
      } else if (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t' ||
                 text_[at_] == '\r') {
        line_ += text_[at_++] == '\n' ? 1 : 0;
      } else {
        break;
      }
    }
    if (at_ == text_.size()) return;
    std::size_t end = at_;
    while (end < text_.size() && (is_word(text_[end]) || text_.substr(end, 2) == "::"))
      end += is_word(text_[end]) ? 1 : 2;
    if (end == at_) ++end;
    token_ = text_.substr(at_, end - at_);
    at_ = end;
  }
  std::string take() {
    std::string word(token_);
    taken_line_ = line_;
    advance();
    return word;
  }
  bool accept(std::string_view expected) {
    if (token_ != expected) return false;
    taken_line_ = line_;
    advance();
    return true;
  }
  void expect(std::string_view expected) {
    if (!accept(expected))
      fail("expected '" + std::string(expected) + "', found '" + std::string(token_) + "'");
  }

  void definition() {
    if (accept("module")) {
      const std::size_t outer = scope_.size();
      scope_ += take() + "::";
      expect("{");
      while (error_.empty() && !token_.empty() && token_ != "}") definition();
      expect("}");
      expect(";");
      scope_.resize(outer);
    } else if (accept("struct")) {
      structure();
    } else if (accept("const")) {
      while (!token_.empty() && token_ != ";") advance();
      expect(";");
    } else {
      fail("expected module, struct or const, found '" + std::string(token_) + "'");
    }
  }

  void structure() {
    auto layout = std::make_unique<MessageLayout>();
    layout->name = scope_ + take();
    expect("{");
    while (error_.empty() && !token_.empty() && token_ != "}") layout->fields.push_back(field());
    expect("}");
    expect(";");
    if (error_.empty() && layout->fields.empty()) fail(layout->name + " has no members");
    if (error_.empty() && !result_.layouts_.emplace(layout->name, std::move(layout)).second) {
      fail("a structure is defined twice");
    }
  }

  FieldLayout field() {
    while (accept("@")) {
      take();
      if (accept("(")) {
        while (!token_.empty() && token_ != ")") advance();
        expect(")");
      }
    }
    FieldLayout field;
    field.sequence = accept("sequence");
    if (field.sequence) expect("<");
    set_type(field, take());
    if (field.sequence) expect(">");
    field.name = take();
    if (accept("[")) {
      field.array = true;
      const std::string count = take();
      const auto [end, error] =
          std::from_chars(count.data(), count.data() + count.size(), field.count);
      if (error != std::errc{} || end != count.data() + count.size() || field.count == 0) {
        fail("an array needs a literal size, found '" + count + "'");
      }
      expect("]");
    }
    expect(";");
    return field;
  }

  void set_type(FieldLayout& field, const std::string& name) {
    static const std::map<std::string, FieldKind, std::less<>> kScalars = {
        {"boolean", FieldKind::kBool}, {"int8", FieldKind::kInt8},
        {"uint8", FieldKind::kUint8},  {"octet", FieldKind::kUint8},
        {"int16", FieldKind::kInt16},  {"uint16", FieldKind::kUint16},
        {"int32", FieldKind::kInt32},  {"uint32", FieldKind::kUint32},
        {"int64", FieldKind::kInt64},  {"uint64", FieldKind::kUint64},
        {"float", FieldKind::kFloat},  {"double", FieldKind::kDouble},
        {"string", FieldKind::kString}};
    if (const auto scalar = kScalars.find(name); scalar != kScalars.end()) {
      field.kind = scalar->second;
      return;
    }
    field.kind = FieldKind::kStruct;
    field.type = result_.find(scope_ + name);
    if (field.type == nullptr) field.type = result_.find(name);
    if (field.type == nullptr) fail("unknown type '" + name + "'");
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  int taken_line_ = 1;  // of the token before token_
  std::string_view token_;
  std::string scope_;
  std::string error_;
  MessageLayouts result_;
};

Result<MessageLayouts> MessageLayouts::parse(std::string_view idl) { return IdlParser(idl).run(); }

const MessageLayouts& MessageLayouts::built_in() {
  static const MessageLayouts layouts = [] {
    auto parsed = parse(idl_text());
    assert(parsed.ok());  // the same text went through fastddsgen; a test keeps both views equal
    return std::move(parsed).value();
  }();
  return layouts;
}

const MessageLayout* MessageLayouts::find(std::string_view name) const {
  if (const auto found = layouts_.find(name); found != layouts_.end()) return found->second.get();
  constexpr std::string_view kInfix = "::dds_::";
  const std::size_t infix = name.find(kInfix);
  if (infix == std::string_view::npos || !name.ends_with('_')) return nullptr;
  std::string plain(name.substr(0, infix + 2));
  plain += name.substr(infix + kInfix.size());
  plain.pop_back();
  const auto found = layouts_.find(plain);
  return found == layouts_.end() ? nullptr : found->second.get();
}

namespace {

void pass(const MessageLayout& layout, CdrCursor& cursor) {
  for (const FieldLayout& field : layout.fields) {
    const std::uint32_t count = field.sequence ? cursor.length() : field.count;
    if (const std::size_t size = wire_size(field.kind); size > 0) {
      // An empty sequence has no padding for elements that are not there.
      const std::uint8_t* first = count > 0 ? cursor.scalars(size, count) : nullptr;
      if (field.kind == FieldKind::kBool && first != nullptr) {
        for (std::uint32_t i = 0; i < count; ++i) {
          if (first[i] > 1) cursor.fail();
        }
      }
    } else if (field.kind == FieldKind::kString) {
      for (std::uint32_t i = 0; i < count && cursor.ok(); ++i) cursor.string();
    } else {
      for (std::uint32_t i = 0; i < count && cursor.ok(); ++i) pass(*field.type, cursor);
    }
    if (!cursor.ok()) return;
  }
}

}  // namespace

bool is_well_formed(const MessageLayout& layout, std::span<const std::uint8_t> cdr) {
  CdrCursor cursor(cdr);
  if (cursor.ok()) pass(layout, cursor);
  return cursor.ok() && cursor.remaining() <= 3;
}

}  // namespace usher::runtime
