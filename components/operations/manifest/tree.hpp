#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/manifest/finding.hpp"

namespace usher::operations {

/// A YAML document whose every node knows where it was written, so that files can be laid over one
/// another and errors still name the line that is wrong.
struct Tree {
  enum class Kind { kNull, kScalar, kList, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  std::string scalar;
  std::vector<Tree> items;     ///< of a list
  std::vector<Entry> entries;  ///< of a map, in the order of the file
  std::vector<Entry> removed;  ///< of a map: what a null of a file above took out; `origin` is the
                               ///< null's
  std::string origin;          ///< "deploy/demo.yaml:12"

  static Tree word(std::string text, std::string origin);
  const Tree* find(const std::string& key) const;
  Tree* find(const std::string& key);
  /// The node as YAML of one line that reads the same in any place: `0.2 m`, `[1, "a: b"]`.
  std::string yaml() const;
};

struct Tree::Entry {
  std::string key;
  Tree value;
};

/// What was found, as an error shows it: one line of at most 80 characters.
std::string brief(const std::string& text);

/// Fails, with the place at the error's end as "(FILE:LINE)" or "(FILE)", on unreadable files, bad
/// YAML, repeated keys, anchors and aliases, second documents, more than 32 levels, more than 1 MB.
Result<Tree> read_tree(const std::string& path);
Result<Tree> parse_tree(const std::string& text, const std::string& where);

/// `over` laid over `base`: maps are merged key by key, anything else is replaced; a null removes,
/// and is a finding where there is nothing to remove.
Tree overlay(Tree base, const Tree& over, std::vector<Finding>& findings);

}  // namespace usher::operations
