#include "foundation/text/compressed_text.hpp"

#include <zlib.h>

#include <array>
#include <memory>

namespace usher {

namespace {
constexpr std::size_t kMaxBytes = std::size_t{1}
                                  << 30;  // of text: refuses what only looks like a small file
}  // namespace

Result<std::string> read_compressed_text(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (file == nullptr) return Error{path + ": cannot be opened"};
  std::string text;
  std::array<char, 65536> block{};
  while (true) {
    const int count = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()));
    if (count < 0)
      return Error{path + ": damaged gzip data after " + std::to_string(text.size()) +
                   " bytes of text"};
    if (count == 0) break;
    text.append(block.data(), static_cast<std::size_t>(count));
    if (text.size() > kMaxBytes)
      return Error{path + ": expected at most " + std::to_string(kMaxBytes) + " bytes of text"};
  }
  int code = Z_OK;
  gzerror(file.get(), &code);
  if (code != Z_OK && code != Z_STREAM_END) return Error{path + ": gzip data ends early"};
  return text;
}

}  // namespace usher
