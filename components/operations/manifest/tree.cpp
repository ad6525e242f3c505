#include "operations/manifest/tree.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace usher::operations {

namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr int kMaxDepth = 32;

std::string place(const std::string& where, const YAML::Mark& mark) {
  return where + ":" + std::to_string(mark.line + 1);
}

Result<Tree> convert(const YAML::Node& node, const std::string& where, int depth) {
  Tree tree;
  tree.origin = place(where, node.Mark());
  if (depth > kMaxDepth) return Error{"nested deeper than 32 levels (" + tree.origin + ")"};
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      tree.kind = Tree::Kind::kScalar;
      tree.scalar = node.Scalar();
      break;
    case YAML::NodeType::Sequence:
      tree.kind = Tree::Kind::kList;
      for (const auto& item : node) {
        auto converted = convert(item, where, depth + 1);
        if (!converted) return converted;
        tree.items.push_back(std::move(converted).value());
      }
      break;
    case YAML::NodeType::Map:
      tree.kind = Tree::Kind::kMap;
      for (const auto& entry : node) {
        if (!entry.first.IsScalar()) {
          return Error{"a key must be a word (" + place(where, entry.first.Mark()) + ")"};
        }
        const std::string& key = entry.first.Scalar();
        if (tree.find(key) != nullptr) {
          return Error{"key '" + key + "' is given twice (" + place(where, entry.first.Mark()) +
                       ")"};
        }
        auto converted = convert(entry.second, where, depth + 1);
        if (!converted) return converted;
        converted.value().origin = place(where, entry.first.Mark());
        tree.entries.emplace_back(key, std::move(converted).value());
      }
      break;
    default:
      break;
  }
  return tree;
}

void write(std::ostream& out, const Tree& tree) {
  const char* separator = "";
  switch (tree.kind) {
    case Tree::Kind::kNull:
      out << "~";
      break;
    case Tree::Kind::kScalar: {
      YAML::Emitter emitter;
      emitter << tree.scalar;
      out << emitter.c_str();
      break;
    }
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
        out << separator << key << ": ";
        write(out, value);
        separator = ", ";
      }
      out << "}";
      break;
  }
}

}  // namespace

const Tree* Tree::find(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const auto& entry) { return entry.first == key; });
  return found == entries.end() ? nullptr : &found->second;
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

Result<Tree> parse_tree(const std::string& text, const std::string& where) {
  if (text.size() > kMaxBytes) return Error{where + " must be at most 1 MB"};
  try {
    return convert(YAML::Load(text), where, 0);
  } catch (const YAML::Exception& exception) {
    return Error{"not valid YAML: " + exception.msg + " (" + place(where, exception.mark) + ")"};
  }
}

Result<Tree> read_tree(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{"cannot read " + path};
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (file.bad()) return Error{"cannot read " + path};
  return parse_tree(text, path);
}

Tree overlay(Tree base, const Tree& over) {
  if (base.kind != Tree::Kind::kMap || over.kind != Tree::Kind::kMap) return over;
  for (const auto& [key, value] : over.entries) {
    Tree* existing = base.find(key);
    if (value.kind == Tree::Kind::kNull) {
      std::erase_if(base.entries, [&key = key](const auto& entry) { return entry.first == key; });
    } else if (existing != nullptr) {
      *existing = overlay(std::move(*existing), value);
    } else {
      base.entries.emplace_back(key, value);
    }
  }
  return base;
}

}  // namespace usher::operations
