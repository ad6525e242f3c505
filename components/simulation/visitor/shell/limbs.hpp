#pragma once

#include <memory>
#include <string>

#include "interaction/finger/core/tap.hpp"
#include "runtime/api/host.hpp"
#include "simulation/visitor/core/mouth.hpp"
#include "simulation/visitor/shell/voice.hpp"

namespace usher::visitor {

/// A visitor's finger and mouth, as devices: lines to a tablet, sound to a microphone. Each may be
/// missing; whoever is at the other end may come and go.
class Limbs {
 public:
  /// Addresses of streams; empty: the visitor has none.
  Limbs(runtime::Host& host, std::shared_ptr<Voice> voice, const std::string& finger,
        const std::string& mouth);
  Limbs(const Limbs&) = delete;
  Limbs& operator=(const Limbs&) = delete;

  bool has_finger() const { return finger_ != nullptr; }
  bool has_mouth() const { return microphone_ != nullptr; }
  void tap(const finger::Tap& tap);
  void say(const std::string& words);
  /// Why it cannot speak; empty: it can.
  const std::string& trouble() const { return trouble_; }

 private:
  void sound(std::uint64_t skipped);

  runtime::Host& host_;
  std::shared_ptr<Voice> voice_;
  Mouth mouth_;
  Random room_;
  runtime::Stream* finger_ = nullptr;
  runtime::Stream* microphone_ = nullptr;
  std::string trouble_;
  runtime::Timer timer_;
};

}  // namespace usher::visitor
