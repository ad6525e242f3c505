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

template <int kInputs, int kNeurons>
void decode(const WrittenNeuron* written, Layer<kInputs, kNeurons>& layer) {
  for (auto& neuron : layer.neurons) {
    const std::string_view text(written->weights);
    if (text.size() != 2 * neuron.weights.size()) std::abort();
    for (std::size_t i = 0; i < neuron.weights.size(); ++i)
      neuron.weights[i] =
          static_cast<std::int8_t>(16 * digit(text[2 * i]) + digit(text[2 * i + 1]));
    neuron.scale = written->scale;
    neuron.bias = written->bias;
    ++written;
  }
}

template <std::size_t kSize>
void rectify(std::array<float, kSize>& values) {
  for (float& value : values) value = std::max(0.0F, value);
}

}  // namespace

Network decode(
    std::span<const WrittenNeuron, Network::kFirst + Network::kSecond + Network::kOutputs>
        neurons) {
  Network network{};
  decode(neurons.data(), network.first);
  decode(neurons.data() + Network::kFirst, network.second);
  decode(neurons.data() + Network::kFirst + Network::kSecond, network.outputs);
  return network;
}

template <int kInputs, int kNeurons>
Classifier::Sums<kInputs, kNeurons>::Sums(const Layer<kInputs, kNeurons>& layer) {
  for (std::size_t k = 0; k < kNeurons; ++k) {
    const auto& neuron = layer.neurons[k];
    for (std::size_t i = 0; i < kInputs; ++i)
      weights[i][k] = neuron.scale * static_cast<float>(neuron.weights[i]);
    biases[k] = neuron.bias;
  }
}

template <int kInputs, int kNeurons>
std::array<float, kNeurons> Classifier::Sums<kInputs, kNeurons>::operator()(
    const std::array<float, kInputs>& inputs) const {
  std::array<float, kNeurons> sums = biases;
  for (std::size_t i = 0; i < kInputs; ++i) {
    for (std::size_t k = 0; k < kNeurons; ++k) sums[k] += weights[i][k] * inputs[i];
  }
  return sums;
}

Classifier::Classifier(const Network& network)
    : network_(network), second_(network.second), outputs_(network.outputs) {
  for (std::size_t k = 0; k < weights_.size(); ++k)
    std::copy(network.first.neurons[k].weights.begin(), network.first.neurons[k].weights.end(),
              weights_[k].begin());
}

Verdict Classifier::judge(const Windows::Inputs& inputs) const {
  std::array<float, Network::kFirst> first;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const auto& weights = weights_[k];
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) sum += weights[i] * inputs[i];
    const auto& neuron = network_.first.neurons[k];
    first[k] = neuron.bias + neuron.scale * static_cast<float>(sum);
  }
  rectify(first);
  auto second = second_(first);
  rectify(second);
  const auto said = outputs_(second);
  return {said[0], kOffset * said[1], kOffset * said[2]};
}

}  // namespace usher::people_detector
