#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "perception/people_detector/core/windows.hpp"

namespace usher::people_detector {

/// A layer of neurons: bias + scale * sum of weights times inputs. Weights are bytes.
template <int kInputs, int kNeurons>
struct Layer {
  struct Neuron {
    std::array<std::int8_t, kInputs> weights;
    float scale;
    float bias;
  };
  std::array<Neuron, kNeurons> neurons;
};

/// Two hidden layers of rectified sums over a window, and what they say about it. Whole numbers and
/// single sums in a fixed order make the result the same on every machine.
struct Network {
  static constexpr int kFirst = 128, kSecond = 32, kOutputs = 3;
  Layer<Windows::kInputs, kFirst> first;
  Layer<kFirst, kSecond> second;
  Layer<kSecond, kOutputs> outputs;  ///< log odds, forward, left
};
/// [m] that 1 is among the outputs that are places.
inline constexpr float kOffset = 0.25F;

/// A neuron as it is written down: two hexadecimal digits for each weight.
struct WrittenNeuron {
  const char* weights;
  float scale, bias;
};
/// The neurons of all layers, one layer after the other. Other digits or another length end the
/// process.
Network decode(
    std::span<const WrittenNeuron, Network::kFirst + Network::kSecond + Network::kOutputs> neurons);

/// The trained network (network_weights.cpp; written by usher-train-people, see the README).
const Network& trained_network();

/// What a network says about a window.
struct Verdict {
  float score = 0.0F;                 ///< log odds that somebody stands in the middle
  float forward = 0.0F, left = 0.0F;  ///< [m] from the window's place to the body's middle
};

/// Evaluates a network over windows.
class Classifier {
 public:
  explicit Classifier(const Network& network);
  Verdict judge(const Windows::Inputs& inputs) const;

 private:
  /// A layer of floating point sums: by input first, so that all neurons are summed side by side.
  template <int kInputs, int kNeurons>
  struct Sums {
    explicit Sums(const Layer<kInputs, kNeurons>& layer);
    std::array<float, kNeurons> operator()(const std::array<float, kInputs>& inputs) const;
    std::array<std::array<float, kNeurons>, kInputs> weights;
    std::array<float, kNeurons> biases;
  };
  const Network& network_;
  std::array<std::array<std::int16_t, Windows::kInputs>, Network::kFirst> weights_;
  Sums<Network::kFirst, Network::kSecond> second_;
  Sums<Network::kSecond, Network::kOutputs> outputs_;
};

}  // namespace usher::people_detector
