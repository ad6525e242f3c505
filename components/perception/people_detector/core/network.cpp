#include "perception/people_detector/core/network.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace usher::people_detector {

namespace {

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  std::abort();
}

}  // namespace

Network decode(const std::array<WrittenNeuron, Network::kHidden>& neurons, float bias) {
  Network network{};
  for (std::size_t k = 0; k < neurons.size(); ++k) {
    const std::string_view text(neurons[k].weights);
    if (text.size() != 2 * network.neurons[k].weights.size()) std::abort();
    for (std::size_t i = 0; i < network.neurons[k].weights.size(); ++i)
      network.neurons[k].weights[i] =
          static_cast<std::int8_t>(16 * digit(text[2 * i]) + digit(text[2 * i + 1]));
    network.neurons[k].scale = neurons[k].scale;
    network.neurons[k].out = neurons[k].out;
  }
  network.bias = bias;
  return network;
}

Classifier::Classifier(const Network& network) : network_(network) {
  for (std::size_t k = 0; k < weights_.size(); ++k)
    std::copy(network.neurons[k].weights.begin(), network.neurons[k].weights.end(),
              weights_[k].begin());
}

float Classifier::score(const Windows::Inputs& inputs) const {
  float score = network_.bias;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const auto& weights = weights_[k];
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) sum += weights[i] * inputs[i];
    const Network::Neuron& neuron = network_.neurons[k];
    score += neuron.out * std::max(0.0F, neuron.scale * static_cast<float>(sum));
  }
  return score;
}

}  // namespace usher::people_detector
