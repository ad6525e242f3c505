#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "support/process.hpp"

namespace usher::test {

/// What happens to frames in one direction of a cable.
struct Line {
  bool cut = false;
  double loss = 0.0;                    ///< probability
  std::chrono::microseconds delay{0};   ///< of every frame
  std::chrono::microseconds jitter{0};  ///< at most so much more; frames overtake one another
};

/// Two machines as network namespaces, `a` and `b`. On one subnet they hang on a cable that this
/// class plays, frame by frame; routed they lie in different subnets behind a router that forwards
/// no multicast. Needs the rights of root.
class TwoNetworks {
 public:
  enum class Kind { kOneSubnet, kRouted };
  /// Nothing, with the reason in `why`, where it is not permitted.
  static std::unique_ptr<TwoNetworks> create(Kind kind, std::string& why);
  ~TwoNetworks();
  TwoNetworks(const TwoNetworks&) = delete;
  TwoNetworks& operator=(const TwoNetworks&) = delete;

  const std::string& a() const { return names_[0]; }
  const std::string& b() const { return names_[1]; }
  std::string address_of_a() const { return address(0); }
  std::string address_of_b() const { return address(1); }

  /// On one subnet only.
  void set(const Line& from_a, const Line& from_b);
  std::uint64_t frames() const { return frames_; }

  /// A program in one of the namespaces.
  static std::unique_ptr<Process> start(const std::string& network, std::vector<std::string> words);
  /// Runs a function whose thread, and all threads that it starts, live in a namespace.
  static void within(const std::string& network, const std::function<void()>& function);

 private:
  explicit TwoNetworks(Kind kind);
  std::string address(int side) const;
  void play();

  const Kind kind_;
  std::string names_[3];  ///< a, b, and what is between them
  int sockets_[2] = {-1, -1};
  std::mutex mutex_;
  Line lines_[2];
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<bool> stop_{false};
  std::thread player_;
};

}  // namespace usher::test
