#include "operations/manifest/tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "foundation/text/suggestion.hpp"

namespace usher::operations {

namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::size_t kMaxDepth = 32;
constexpr std::size_t kBrief = 80;

std::string place(const std::string& where, const YAML::Mark& mark) {
  return where + ":" + std::to_string(std::max(mark.line, 0) + 1);
}

/// Thrown through yaml-cpp's parser, caught in parse_tree.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Builds the tree from the parser's events, so that what we do not want never costs anything.
class Builder final : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& where) : where_(where) {}

  Tree take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (std::exchange(started_, true)) refuse("a second document starts", mark);
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(Tree::Kind::kNull, mark, anchor, {});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    refuse("aliases are not allowed", mark);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& value) override {
    add(Tree::Kind::kScalar, mark, anchor, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({add(Tree::Kind::kList, mark, anchor, {})});
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({add(Tree::Kind::kMap, mark, anchor, {})});
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  /// A list or map that is being read. Its address is stable: siblings come only after it is
  /// closed.
  struct Open {
    Tree* tree;
    bool key_read = false;
  };

  [[noreturn]] void refuse(const std::string& why, const YAML::Mark& mark) const {
    throw Refused(why + " (" + place(where_, mark) + ")");
  }

  Tree* add(Tree::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor,
            const std::string& scalar) {
    if (anchor != 0) refuse("anchors are not allowed", mark);
    if (open_.size() > kMaxDepth) refuse("nested deeper than 32 levels", mark);
    Tree tree;
    tree.kind = kind;
    tree.scalar = scalar;
    tree.origin = place(where_, mark);
    if (open_.empty()) {
      root_ = std::move(tree);
      return &root_;
    }
    Open& parent = open_.back();
    if (parent.tree->kind == Tree::Kind::kList)
      return &parent.tree->items.emplace_back(std::move(tree));
    auto& entries = parent.tree->entries;
    parent.key_read = !parent.key_read;
    if (parent.key_read) {
      if (kind != Tree::Kind::kScalar) refuse("a key must be a word", mark);
      if (parent.tree->find(scalar) != nullptr)
        refuse("key '" + brief(scalar) + "' is given twice", mark);
      entries.push_back({scalar, std::move(tree)});
      return nullptr;
    }
    tree.origin = std::move(entries.back().value.origin);  // of the key
    entries.back().value = std::move(tree);
    return &entries.back().value;
  }

  const std::string& where_;
  Tree root_;
  std::vector<Open> open_;
  bool started_ = false;
};

/// Whether a scalar reads the same without quotes, in whatever place.
bool is_plain(std::string_view text) {
  const auto is_word = [](char c) {  // or a path
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '/';
  };
  for (const std::string_view null : {"null", "Null", "NULL"}) {
    if (text == null) return false;
  }
  const std::string_view start =
      !text.empty() && (text[0] == '-' || text[0] == '+') ? text.substr(1) : text;
  if (start.empty() ||
      !(is_word(start[0]) || (start.size() > 1 && start[0] == '.' && is_word(start[1]))))
    return false;
  return text.back() != ' ' && std::all_of(start.begin(), start.end(), [&](char c) {
           return is_word(c) || std::string_view(" .+-").find(c) != std::string_view::npos;
         });
}

void write_scalar(std::ostream& out, const std::string& text) {
  if (is_plain(text)) {
    out << text;
    return;
  }
  out << '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out << '\\' << c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof(escape), "\\x%02x", static_cast<unsigned>(c));
      out << escape;
    } else {
      out << c;
    }
  }
  out << '"';
}

void write(std::ostream& out, const Tree& tree) {
  const char* separator = "";
  switch (tree.kind) {
    case Tree::Kind::kNull:
      out << "~";
      break;
    case Tree::Kind::kScalar:
      write_scalar(out, tree.scalar);
      break;
    case Tree::Kind::kList:
      out << "[";
      for (const auto& item : tree.items) {
        out << separator;
        write(out, item);
        separator = ", ";
      }
      out << "]";
      break;
    case Tree::Kind::kMap:
      out << "{";
      for (const auto& [key, value] : tree.entries) {
        out << separator;
        write_scalar(out, key);
        out << ": ";
        write(out, value);
        separator = ", ";
      }
      out << "}";
      break;
  }
}

}  // namespace

Tree Tree::word(std::string text, std::string origin) {
  Tree tree;
  tree.kind = Kind::kScalar;
  tree.scalar = std::move(text);
  tree.origin = std::move(origin);
  return tree;
}

const Tree* Tree::find(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const auto& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &found->value;
}

Tree* Tree::find(const std::string& key) {
  return const_cast<Tree*>(
      std::as_const(*this).find(key));  // NOLINT: the object itself is not const
}

std::string Tree::yaml() const {
  std::ostringstream out;
  write(out, *this);
  return out.str();
}

std::string brief(const std::string& text) {
  std::size_t end = std::min(text.size(), kBrief);
  while (end > 0 && end < text.size() && (text[end] & 0xC0) == 0x80) --end;  // no half of a letter
  std::string line = text.substr(0, end);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return end < text.size() ? line + "..." : line;
}

Result<Tree> parse_tree(const std::string& text, const std::string& where) {
  if (text.size() > kMaxBytes) return Error{"it must be at most 1 MB (" + where + ")"};
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Builder builder(where);
    while (parser.HandleNextDocument(builder)) {
    }
    Tree tree = builder.take();
    if (tree.origin.empty()) tree.origin = where + ":1";
    return tree;
  } catch (const Refused& refused) {
    return Error{refused.what()};
  } catch (const YAML::Exception& exception) {
    return Error{"not valid YAML: " + brief(exception.msg) + " (" + place(where, exception.mark) +
                 ")"};
  }
}

Result<Tree> read_tree(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return Error{"it is a directory (" + path + ")"};
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{"it cannot be read (" + path + ")"};
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return Error{"it cannot be read (" + path + ")"};
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse_tree(text, path);
}

Tree overlay(Tree base, const Tree& over, std::vector<Finding>& findings) {
  if (base.kind != Tree::Kind::kMap || over.kind != Tree::Kind::kMap) return over;
  std::vector<std::string> known;
  for (const auto& entry : base.entries) known.push_back(entry.key);
  for (const auto& [key, value] : over.entries) {
    Tree* existing = base.find(key);
    if (value.kind == Tree::Kind::kNull) {
      if (existing == nullptr)
        findings.push_back({Verdict::kUnknownKey,
                            "there is no '" + brief(key) + "' here that null could remove" +
                                suggestion(key, known),
                            value.origin});
      if (existing != nullptr) {
        base.removed.push_back({key, std::move(*existing)});
        base.removed.back().value.origin = value.origin;
      }
      std::erase_if(base.entries, [&key = key](const auto& entry) { return entry.key == key; });
    } else if (existing != nullptr) {
      *existing = overlay(std::move(*existing), value, findings);
    } else {
      base.entries.push_back({key, value});
    }
  }
  return base;
}

}  // namespace usher::operations
