#pragma once

#include <optional>
#include <span>
#include <string>

#include "foundation/result/result.hpp"
#include "runtime/api/message_type.hpp"

namespace usher::runtime {

/// Host::keep and Host::kept: one file per key, replaced atomically and on the disk when keep()
/// returns, so that a crash at any moment leaves the old value or the new one.
class FileStore {
 public:
  static constexpr std::size_t kMaxBytes = 1 << 20;

  /// An empty folder stores nothing: keep() succeeds, kept() finds nothing. The folder is made when
  /// it is needed.
  explicit FileStore(std::string folder) : folder_(std::move(folder)) {}

  /// Keys consist of a-z, 0-9, '_', '-' and '.', at most 64, and do not start with '.'.
  Status keep(const std::string& key, std::span<const std::uint8_t> bytes) const;
  /// Nothing where no file is; an error where one is that cannot be read.
  Result<std::optional<Bytes>> kept(const std::string& key) const;

 private:
  std::string folder_;
};

}  // namespace usher::runtime
