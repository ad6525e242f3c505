#pragma once

#include <string>
#include <vector>

namespace usher::operations {

/// A table for the terminal: columns as wide as their widest entry, numbers (by content) to the
/// right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::size_t size() const { return rows_.size() - 1; }
  std::string text() const;
  std::string markdown() const;

 private:
  std::vector<std::string> render(const std::string& separator) const;
  std::vector<std::vector<std::string>> rows_;
};

/// printf for one value: format("%.2f", x).
std::string format(const char* pattern, double value);
/// The same for a table: "-" where there is none, as the mean of nothing.
std::string figure(const char* pattern, double value);

}  // namespace usher::operations
