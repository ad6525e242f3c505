#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace usher::runtime {

/// Messages that wait for a slow port, in order. Fixed memory, no allocation after the constructor.
class Outbox {
 public:
  enum class Kind : std::uint8_t {
    kEach = 0,    ///< has to arrive
    kLatest = 1,  ///< gives way to the next one of this kind, unless a part of it was sent
    kWill = 2,    ///< likewise; for the guard itself (Guard::will)
  };
  static constexpr std::size_t kMostBytes = 65536;
  static constexpr std::size_t kMostMessages = 1024;

  Outbox();

  /// False, and the message is not taken, when kMostBytes or kMostMessages wait. An empty message
  /// is taken and is nothing.
  bool push(Kind kind, std::span<const std::uint8_t> message);

  /// Everything that waits, and what is left of the first message.
  std::span<const std::uint8_t> waiting() const { return bytes_; }
  std::span<const std::uint8_t> first() const;
  bool empty() const { return bytes_.empty(); }

  /// The port took so many bytes of waiting().
  void sent(std::size_t count);
  /// Forgets all but the rest of a message that is on its way.
  void drop_unsent();
  /// Forgets everything.
  void clear();

 private:
  struct Message {
    Kind kind;
    std::size_t length;  ///< that is not sent yet
  };
  void drop(Kind kind);

  std::vector<std::uint8_t> bytes_;
  std::vector<Message> messages_;
  bool first_under_way_ = false;  ///< a part of the first one was sent
};

}  // namespace usher::runtime
