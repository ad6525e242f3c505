#pragma once

#include <cassert>
#include <cstdint>
#include <vector>

namespace usher::global_planner {

/// Many first-in first-out lists of 64-bit entries over one pool of chunks: the buckets of a bucket
/// queue. A list takes chunks as it grows and returns them as it is read, so that the working set
/// stays in the cache.
class BandQueue {
 public:
  using Entry = std::uint64_t;

  /// Empties all lists. Allocates only when `lists` or `reserve` [entries] is larger than ever
  /// before.
  void reset(std::uint32_t lists, std::size_t reserve) {
    const std::size_t chunks = lists + reserve / kChunk + 1;
    if (pool_.size() < chunks * kChunk) pool_.resize(chunks * kChunk);
    begin_.resize(lists);
    end_.resize(lists);
    for (std::uint32_t i = 0; i < lists; ++i) begin_[i] = end_[i] = first_entry(i);
    unused_ = lists;
    free_.reserve(pool_.size() / kChunk);
    free_.clear();
  }

  bool empty(std::uint32_t list) const { return begin_[list] == end_[list]; }

  void push(std::uint32_t list, Entry entry) {
    std::uint32_t& end = end_[list];
    pool_[end] = entry;
    if (++end % kChunk == 0) end = extend(end);
  }

  /// Reads a list in order while it may grow:
  ///     for (auto at = queue.begin(list); !queue.at_end(list, at);) use(queue.take(at));   then
  ///     queue.consume(list)
  /// What was read is gone: the list must be read to its end.
  std::uint32_t begin(std::uint32_t list) const { return begin_[list]; }
  bool at_end(std::uint32_t list, std::uint32_t at) const { return at == end_[list]; }
  Entry take(std::uint32_t& at) {
    const Entry entry = pool_[at];
    if (++at % kChunk == 0) at = follow(at);
    return entry;
  }
  void consume(std::uint32_t list) { begin_[list] = end_[list]; }

 private:
  static constexpr std::uint32_t kChunk = 64;  // entry 0 is the number of the next chunk
  static std::uint32_t first_entry(std::uint32_t chunk) { return chunk * kChunk + 1; }

  [[gnu::noinline]] std::uint32_t extend(std::uint32_t end) {
    std::uint32_t chunk = 0;
    if (!free_.empty()) {
      chunk = free_.back();
      free_.pop_back();
    } else {
      chunk = unused_++;
      if (pool_.size() < (static_cast<std::size_t>(chunk) + 1) * kChunk) {
        pool_.resize(pool_.size() * 2);
        free_.reserve(pool_.size() / kChunk);
      }
    }
    pool_[end - kChunk] = chunk;
    return first_entry(chunk);
  }

  [[gnu::noinline]] std::uint32_t follow(std::uint32_t next) {
    const std::uint32_t chunk = next / kChunk - 1;
    free_.push_back(chunk);
    return first_entry(static_cast<std::uint32_t>(pool_[next - kChunk]));
  }

  std::vector<Entry> pool_;
  std::vector<std::uint32_t> begin_, end_;  // per list, indices into the pool
  std::vector<std::uint32_t> free_;         // chunks given back
  std::uint32_t unused_ = 0;                // chunks from here on were never taken
};

}  // namespace usher::global_planner
