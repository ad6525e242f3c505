// usher-train-people: trains the network of the people detector on random scenes and writes it as
// perception/people_detector/core/network_weights.cpp. Deterministic.
#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numeric>

#include "operations/people_study/scoring.hpp"

namespace {

using namespace usher;
using namespace usher::people_study;
using people_detector::Candidate;
using people_detector::Network;
using people_detector::Windows;

constexpr std::uint64_t kFirstSeed = 1'000'000;  // those of benchmark and experiment are smaller
constexpr int kInputs = Windows::kInputs;

struct Sample {
  std::array<std::int8_t, kInputs> inputs;
  bool person;
};

enum class Label { kPerson, kNobody, kEither };

/// Beside the middle of a person a window is neither, unless it lies between two.
Label label_of(const Candidate& place, std::span<const Truth> truths) {
  constexpr double kMiddle = 0.11, kBeside = 0.3;  // [m]
  constexpr double kLearnt = 0.12;                 // [m^2] visible of who is an example
  bool left = false, right = false, hidden = false;
  for (const Truth& truth : truths) {
    const double aside = static_cast<double>(place.left) - truth.left;
    const double before = truth.forward - static_cast<double>(place.forward);
    if (truth.area <= 0.0 || before < -0.3 || before > 0.5 || std::abs(aside) > kBeside) continue;
    if (truth.area >= kLearnt && std::abs(aside) < kMiddle) return Label::kPerson;
    hidden = hidden || truth.area < kLearnt;
    (aside > 0.0 ? left : right) = true;
  }
  if (left && right && !hidden) return Label::kNobody;
  return left || right ? Label::kEither : Label::kNobody;
}

/// Windows of scenes: all with people, of the others a share or, with a network, those that it
/// takes for people or nearly.
void collect(int first, int count, const Network* network, double share,
             std::vector<Sample>& samples) {
  Studio studio;
  Windows windows(studio.intrinsics(), {});
  auto classifier = network ? std::make_unique<people_detector::Classifier>(*network) : nullptr;
  Windows::Inputs inputs;
  Random random(static_cast<std::uint64_t>(first));
  for (int i = first; i < first + count; ++i) {
    const std::uint64_t seed = kFirstSeed + static_cast<std::uint64_t>(i);
    const auto shot = studio.take(random_scene(seed), seed);
    if (!shot) std::fprintf(stderr, "%s\n", shot.error().c_str()), std::exit(1);
    windows.take(shot->processed, shot->view);
    for (const Candidate& place : windows.candidates()) {
      const Label label = label_of(place, shot->truths);
      if (label == Label::kEither) continue;
      windows.describe(place, inputs);
      const bool hard = classifier && classifier->score(inputs) > -2.5F;
      if (label == Label::kNobody && !hard && random.uniform() > share) continue;
      Sample sample{{}, label == Label::kPerson};
      std::transform(inputs.begin(), inputs.end(), sample.inputs.begin(),
                     [](std::int16_t value) { return static_cast<std::int8_t>(value); });
      samples.push_back(sample);
    }
    if (i % 250 == 0) std::fprintf(stderr, "scene %d, %zu windows\n", i, samples.size());
  }
}

/// The network while it is trained: by Adam [kingma2015adam] on the logistic loss.
class Trainer {
 public:
  Trainer() {
    Random random(7);
    for (int k = 0; k < Network::kHidden; ++k) {
      for (int i = 0; i < kInputs; ++i)
        weights_(k, i) = static_cast<float>(random.gaussian(0.0, 0.05));
      out_(k) = static_cast<float>(random.gaussian(0.0, 0.3));
    }
  }

  void epoch(const std::vector<Sample>& samples, float rate, std::uint64_t seed) {
    std::vector<std::size_t> order(samples.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random random(seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    double loss = 0.0;
    for (std::size_t first = 0; first + kBatch <= order.size(); first += kBatch)
      loss += step(samples, std::span(order).subspan(first, kBatch), rate, random);
    std::fprintf(stderr, "loss %.5f\n", loss / static_cast<double>(order.size()));
  }

  Network network() const {
    Network result{};
    for (int k = 0; k < Network::kHidden; ++k) {
      auto& neuron = result.neurons[static_cast<std::size_t>(k)];
      const float largest = std::max(1e-6F, weights_.row(k).cwiseAbs().maxCoeff());
      for (int i = 0; i < kInputs; ++i)
        neuron.weights[static_cast<std::size_t>(i)] =
            static_cast<std::int8_t>(std::lround(weights_(k, i) / largest * 127.0F));
      neuron.scale = largest / 127.0F / Windows::kOne;
      neuron.out = out_(k);
    }
    result.bias = bias_;
    return result;
  }

 private:
  static constexpr std::size_t kBatch = 256;
  static constexpr float kDecay = 5e-3F;

  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// A sample as a column, half of them mirrored.
  static void place(const Sample& sample, bool mirrored, Eigen::Ref<Eigen::VectorXf> column) {
    constexpr int kCells = Windows::kAcross * Windows::kUp;
    for (int cell = 0; cell < kCells; ++cell) {
      const int across = cell % Windows::kAcross;
      const int from = mirrored ? cell - across + Windows::kAcross - 1 - across : cell;
      for (int c = 0; c < Windows::kChannels; ++c)
        column(cell * Windows::kChannels + c) =
            sample.inputs[static_cast<std::size_t>(from * Windows::kChannels + c)] /
            float{Windows::kOne};
    }
    for (int i = kCells * Windows::kChannels; i < kInputs; ++i)
      column(i) = sample.inputs[static_cast<std::size_t>(i)] / float{Windows::kOne};
  }

  double step(const std::vector<Sample>& samples, std::span<const std::size_t> batch, float rate,
              Random& random) {
    for (std::size_t i = 0; i < kBatch; ++i)
      place(samples[batch[i]], random.uniform() < 0.5, inputs_.col(static_cast<Eigen::Index>(i)));
    hidden_.noalias() = weights_ * inputs_;
    hidden_ = hidden_.cwiseMax(0.0F);
    Eigen::RowVectorXf odds = out_.transpose() * hidden_;
    odds.array() += bias_;
    double loss = 0.0;
    for (Eigen::Index i = 0; i < odds.size(); ++i) {
      const bool person = samples[batch[static_cast<std::size_t>(i)]].person;
      const float probability = 1.0F / (1.0F + std::exp(-odds(i)));
      loss -= std::log(std::max(1e-7F, person ? probability : 1.0F - probability));
      odds(i) = (probability - (person ? 1.0F : 0.0F)) / kBatch;
    }
    const Eigen::VectorXf out_slope = hidden_ * odds.transpose();
    Matrix back = out_ * odds;
    back.array() *= (hidden_.array() > 0.0F).cast<float>();
    Matrix slope = back * inputs_.transpose();
    ++steps_;
    const float correction =
        std::sqrt(1.0F - std::pow(0.999F, float(steps_))) / (1.0F - std::pow(0.9F, float(steps_)));
    const auto move = [&](auto& value, const auto& gradient, auto& mean, auto& square) {
      mean = 0.9F * mean + 0.1F * gradient;
      square = 0.999F * square + 0.001F * gradient.cwiseProduct(gradient);
      value.array() -= rate * correction * mean.array() / (square.array().sqrt() + 1e-8F);
    };
    weights_ *= 1.0F - rate * kDecay;
    move(weights_, slope, mean_, square_);
    move(out_, out_slope, out_mean_, out_square_);
    bias_ -= rate * odds.sum() * 4.0F;
    return loss;
  }

  Matrix weights_ = Matrix::Zero(Network::kHidden, kInputs), mean_ = weights_, square_ = weights_;
  Eigen::VectorXf out_ = Eigen::VectorXf::Zero(Network::kHidden), out_mean_ = out_,
                  out_square_ = out_;
  float bias_ = -1.0F;
  long steps_ = 0;
  Eigen::MatrixXf inputs_ = Eigen::MatrixXf::Zero(kInputs, kBatch);
  Matrix hidden_;
};

constexpr std::array kThresholds{-2.0, -1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0};

/// The scores of unseen scenes at several thresholds.
std::array<Score, kThresholds.size()> test(const Network& network, int scenes) {
  Studio studio;
  people_detector::DetectorConfig config;
  config.threshold = kThresholds.front();
  auto detector =
      people_detector::DepthDetector::make(studio.intrinsics(), config, network).value();
  std::array<Score, kThresholds.size()> scores;
  for (int i = 0; i < scenes; ++i) {
    const std::uint64_t seed = 2 * kFirstSeed + static_cast<std::uint64_t>(i);
    const auto shot = studio.take(random_scene(seed), seed).value();
    const auto found = detector.find(shot.processed, shot.view).value();
    std::vector<people_detector::Sighting> sightings(found.begin(), found.end());
    for (std::size_t k = 0; k < scores.size(); ++k) {
      std::erase_if(sightings, [&](const auto& one) { return one.score < kThresholds[k]; });
      scores[k] += judge(sightings, shot.truths);
    }
  }
  return scores;
}

/// Weights as two hexadecimal digits each, 46 to a line.
void write(const Network& network, const std::string& path) {
  std::ofstream file(path);
  file << "// Written by usher-train-people; see the component's README.\n"
          "#include \"perception/people_detector/core/network.hpp\"\n\n"
          "namespace usher::people_detector {\n\n"
          "const Network& trained_network() {\n"
          "  static const Network network = decode(\n      {{\n";
  char text[64];
  for (const auto& neuron : network.neurons) {
    file << "          {";
    for (std::size_t i = 0; i < neuron.weights.size(); ++i) {
      if (i % 40 == 0) file << (i > 0 ? "\"\n           \"" : "\"");
      std::snprintf(text, sizeof text, "%02x",
                    static_cast<unsigned>(static_cast<std::uint8_t>(neuron.weights[i])));
      file << text;
    }
    std::snprintf(text, sizeof text, "\",\n           %.9eF, %.9eF},\n",
                  static_cast<double>(neuron.scale), static_cast<double>(neuron.out));
    file << text;
  }
  std::snprintf(text, sizeof text, "      }},\n      %.9eF);\n", static_cast<double>(network.bias));
  file << text << "  return network;\n}\n\n}  // namespace usher::people_detector\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Trains the network of the people detector on random scenes");
  std::string out = "network_weights.cpp";
  int scenes = 1800, epochs = 14;
  app.add_option("--out", out, "Where the network is written");
  app.add_option("--scenes", scenes, "Of each of the two rounds")->check(CLI::Range(10, 100000));
  app.add_option("--epochs", epochs, "Of each of the two rounds")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  std::vector<Sample> samples;
  Trainer trainer;
  const auto train = [&] {
    for (int i = 0; i < epochs; ++i)
      trainer.epoch(samples, 2e-3F * std::pow(0.02F, float(i) / float(epochs)),
                    static_cast<std::uint64_t>(i));
  };
  collect(0, scenes, nullptr, 0.15, samples);
  train();
  const Network first = trainer.network();
  collect(scenes, scenes, &first, 0.03, samples);
  train();
  const Network network = trainer.network();
  write(network, out);
  const auto scores = test(network, 200);
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const Score& score = scores[k];
    std::printf("threshold %4.1f: recall %.4f precision %.4f error %.3f m (%d people)\n",
                kThresholds[k], score.recall(), score.precision(),
                score.error / std::max(1, score.found), score.found + score.missed);
  }
  return 0;
}
