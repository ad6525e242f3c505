#pragma once

#include <array>
#include <cstdint>

#include "perception/people_detector/core/windows.hpp"

namespace usher::people_detector {

/// One hidden layer over a window: score = bias + sum_k out_k max(0, scale_k (w_k . inputs)).
/// Weights are bytes, so that the result is the same on every machine.
struct Network {
  static constexpr int kHidden = 24;
  struct Neuron {
    std::array<std::int8_t, Windows::kInputs> weights;
    float scale;
    float out;
  };
  std::array<Neuron, kHidden> neurons;
  float bias;
};

/// A neuron as it is written down: two hexadecimal digits for each weight.
struct WrittenNeuron {
  const char* weights;
  float scale, out;
};
/// Other digits or another length end the process.
Network decode(const std::array<WrittenNeuron, Network::kHidden>& neurons, float bias);

/// The trained network (network_weights.cpp; written by usher-train-people, see the README).
const Network& trained_network();

/// Evaluates a network over windows.
class Classifier {
 public:
  explicit Classifier(const Network& network);
  /// Log odds that a person stands in the middle of the window.
  float score(const Windows::Inputs& inputs) const;

 private:
  const Network& network_;
  std::array<std::array<std::int16_t, Windows::kInputs>, Network::kHidden> weights_;
};

}  // namespace usher::people_detector
