#include "runtime/dds/file_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace usher::runtime {
namespace {

/// Closes at the end of its scope.
class File {
 public:
  File(const std::string& path, int flags)
      : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  bool open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

Error failure(const std::string& what, const std::string& path) {
  return Error{"cannot " + what + ' ' + path + ": " + std::strerror(errno)};
}

Status check_key(const std::string& key) {
  const bool allowed =
      !key.empty() && key.size() <= 64 && key[0] != '.' && std::ranges::all_of(key, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
      });
  if (allowed) return {};
  return Error{"a key has 1 to 64 characters of a-z, 0-9, '_', '-', '.' and no '.' first, found '" +
               key + "'"};
}

bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Status FileStore::keep(const std::string& key, std::span<const std::uint8_t> bytes) const {
  if (Status status = check_key(key); !status) return status;
  if (bytes.size() > kMaxBytes) {
    return Error{"at most " + std::to_string(kMaxBytes) + " bytes can be kept, '" + key + "' has " +
                 std::to_string(bytes.size())};
  }
  if (folder_.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const std::string path = folder_ + '/' + key;
  const std::string temporary = folder_ + "/." + key + ".new";
  {
    const File file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (!file.open() || !write_all(file.descriptor(), bytes) || ::fsync(file.descriptor()) != 0) {
      return failure("write", temporary);
    }
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return failure("replace", path);
  const File folder(folder_, O_RDONLY | O_DIRECTORY);
  if (!folder.open() || ::fsync(folder.descriptor()) != 0) return failure("sync", folder_);
  return {};
}

Result<std::optional<Bytes>> FileStore::kept(const std::string& key) const {
  if (const Status status = check_key(key); !status) return Error{status.error()};
  if (folder_.empty()) return std::optional<Bytes>();
  const std::string path = folder_ + '/' + key;
  const File file(path, O_RDONLY);
  if (!file.open() && errno == ENOENT) return std::optional<Bytes>();
  struct stat state {};
  if (!file.open() || ::fstat(file.descriptor(), &state) != 0) return failure("read", path);
  if (static_cast<std::size_t>(state.st_size) > kMaxBytes)
    return Error{"cannot read " + path + ": it has more than 1 MB"};
  Bytes bytes(static_cast<std::size_t>(state.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(file.descriptor(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure("read", path);
    if (count == 0)
      return Error{"cannot read " + path + ": it ends after " + std::to_string(done) + " of " +
                   std::to_string(bytes.size()) + " bytes"};
    done += static_cast<std::size_t>(count);
  }
  return std::optional(std::move(bytes));
}

}  // namespace usher::runtime
