// usher-train-people: trains the network of the people detector on random scenes and writes it as
// perception/people_detector/core/network_weights.cpp. Deterministic.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numeric>

#include "operations/command_line/usage.hpp"
#include "operations/people_study/scoring.hpp"

namespace {

using namespace usher;
using namespace usher::people_study;
using people_detector::Candidate;
using people_detector::Network;
using people_detector::Windows;

// Those of benchmark and experiment are smaller.
constexpr std::uint64_t kUsualSeeds = 1'000'000, kHardSeeds = 1'500'000, kUnseenSeeds = 2'000'000;
constexpr int kInputs = Windows::kInputs;

struct Sample {
  std::array<std::int8_t, kInputs> inputs;
  bool person;
  float forward, left;  // [kOffset] from the window to the person
};

enum class Label { kPerson, kNobody, kEither };
struct Answer {
  Label label = Label::kNobody;
  float forward = 0.0F, left = 0.0F;  // [kOffset]
};

/// Beside the middle of a person a window is neither, unless it lies between two.
Answer answer_to(const Candidate& place, std::span<const Truth> truths) {
  constexpr double kMiddle = 0.14, kBeside = 0.3;  // [m]
  constexpr double kLearnt = 0.12;                 // [m^2] visible of who is an example
  bool left = false, right = false, hidden = false;
  double nearest = kMiddle;
  Answer answer;
  for (const Truth& truth : truths) {
    const double aside = static_cast<double>(place.left) - truth.left;
    const double before = truth.forward - static_cast<double>(place.forward);
    if (truth.area <= 0.0 || before < -0.3 || before > 0.5 || std::abs(aside) > kBeside) continue;
    if (truth.area >= kLearnt && std::abs(aside) < nearest) {
      nearest = std::abs(aside);
      answer = {Label::kPerson, static_cast<float>(before) / people_detector::kOffset,
                static_cast<float>(-aside) / people_detector::kOffset};
    }
    hidden = hidden || truth.area < kLearnt;
    (aside > 0.0 ? left : right) = true;
  }
  if (answer.label == Label::kPerson || (left && right && !hidden)) return answer;
  if (left || right) answer.label = Label::kEither;
  return answer;
}

enum Camera : std::size_t { kKinect, kRear, kCameras };

/// Scenes, rendered, one after the other.
class Scenes {
 public:
  const imaging::Intrinsics& intrinsics(Camera camera) const {
    return studios_[camera].intrinsics();
  }
  /// Every second one is seen by the rear camera, every third is a hard one.
  Studio::Shot next_to_learn(Camera& camera) {
    camera = ++turn_ % 2 == 0 ? kRear : kKinect;
    return turn_ % 3 == 0 ? take(camera, hard_++, Crowd::kHard)
                          : take(camera, usual_++, Crowd::kUsual);
  }
  Studio::Shot unseen(Camera camera, int number) {
    return take(camera, kUnseenSeeds + static_cast<std::uint64_t>(number), Crowd::kUsual);
  }

 private:
  Studio::Shot take(Camera camera, std::uint64_t seed, Crowd crowd) {
    const Scene scene = camera == kRear ? rear_scene(seed, crowd) : random_scene(seed, crowd);
    const auto shot = studios_[camera].take(scene, seed);
    if (!shot) std::fprintf(stderr, "%s\n", shot.error().c_str()), std::exit(1);
    return *shot;
  }

  std::array<Studio, kCameras> studios_{Studio(), Studio(rendering::rear_camera())};
  std::uint64_t usual_ = kUsualSeeds, hard_ = kHardSeeds;
  int turn_ = 0;
};

/// Windows of scenes: all with people, of the others a share or, with a network, those that it
/// takes for people or nearly.
void collect(Scenes& scenes, int count, const Network* network, double share,
             std::vector<Sample>& samples) {
  std::array<Windows, kCameras> of_camera{Windows(scenes.intrinsics(kKinect), {}),
                                          Windows(scenes.intrinsics(kRear), {})};
  auto classifier = network ? std::make_unique<people_detector::Classifier>(*network) : nullptr;
  Windows::Inputs inputs;
  Random random(samples.size());
  for (int i = 0; i < count; ++i) {
    Camera camera{};
    const auto shot = scenes.next_to_learn(camera);
    Windows& windows = of_camera[camera];
    windows.take(shot.processed, shot.view);
    for (const Candidate& place : windows.candidates()) {
      const Answer answer = answer_to(place, shot.truths);
      if (answer.label == Label::kEither) continue;
      windows.describe(place, inputs);
      const bool hard = classifier && classifier->judge(inputs).score > -3.0F;
      if (answer.label == Label::kNobody && !hard && random.uniform() > share) continue;
      Sample sample{{}, answer.label == Label::kPerson, answer.forward, answer.left};
      std::transform(inputs.begin(), inputs.end(), sample.inputs.begin(),
                     [](std::int16_t value) { return static_cast<std::int8_t>(value); });
      samples.push_back(sample);
    }
    if (i % 250 == 0) std::fprintf(stderr, "scene %d, %zu windows\n", i, samples.size());
  }
}

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Weights that move by Adam [kingma2015adam].
class Moved {
 public:
  Moved(Eigen::Index rows, Eigen::Index columns, double sigma, Random& random)
      : value(rows, columns), mean_(Matrix::Zero(rows, columns)), square_(mean_) {
    for (Eigen::Index i = 0; i < value.size(); ++i)
      value.data()[i] = static_cast<float>(random.gaussian(0.0, sigma));
  }
  void step(const Matrix& slope, float rate, float correction) {
    mean_ = 0.9F * mean_ + 0.1F * slope;
    square_ = 0.999F * square_ + 0.001F * slope.cwiseProduct(slope);
    value.array() -= rate * correction * mean_.array() / (square_.array().sqrt() + 1e-8F);
  }

  Matrix value;

 private:
  Matrix mean_, square_;
};

/// A layer while it is trained.
struct TrainedLayer {
  TrainedLayer(Eigen::Index inputs, Eigen::Index neurons, double sigma, Random& random)
      : weights(neurons, inputs, sigma, random), biases(neurons, 1, 0.0, random) {}

  void forward(const Matrix& inputs, bool rectified) {
    sums.noalias() = weights.value * inputs;
    sums.colwise() += biases.value.col(0);
    if (rectified) sums = sums.cwiseMax(0.0F);
  }
  /// `slopes` of the sums; the result is the slopes of the inputs.
  Matrix backward(const Matrix& inputs, const Matrix& slopes, bool wanted, float rate,
                  float correction) {
    Matrix back;
    if (wanted) back.noalias() = weights.value.transpose() * slopes;
    weights_slope_.noalias() = slopes * inputs.transpose();
    weights.value *= 1.0F - rate * kDecay;
    weights.step(weights_slope_, rate, correction);
    biases.step(slopes.rowwise().sum(), rate, correction);
    return back;
  }
  template <int kIn, int kNeurons>
  void write(people_detector::Layer<kIn, kNeurons>& layer, float one) const {
    for (int k = 0; k < kNeurons; ++k) {
      auto& neuron = layer.neurons[static_cast<std::size_t>(k)];
      const float largest = std::max(1e-6F, weights.value.row(k).cwiseAbs().maxCoeff());
      for (int i = 0; i < kIn; ++i)
        neuron.weights[static_cast<std::size_t>(i)] =
            static_cast<std::int8_t>(std::lround(weights.value(k, i) / largest * 127.0F));
      neuron.scale = largest / 127.0F / one;
      neuron.bias = biases.value(k, 0);
    }
  }

  static constexpr float kDecay = 5e-3F;
  Moved weights, biases;
  Matrix sums;

 private:
  Matrix weights_slope_;
};

/// The network while it is trained: the logistic loss of the score and Huber's of the place.
class Trainer {
 public:
  Trainer()
      : random_(7),
        first_(kInputs, Network::kFirst, 0.05, random_),
        second_(Network::kFirst, Network::kSecond, 0.18, random_),
        outputs_(Network::kSecond, Network::kOutputs, 0.2, random_) {}

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
    first_.write(result.first, Windows::kOne);
    second_.write(result.second, 1.0F);
    outputs_.write(result.outputs, 1.0F);
    return result;
  }

 private:
  static constexpr std::size_t kBatch = 256;
  static constexpr float kPlaceShare = 0.5F;  // of the place's loss

  /// A sample as a row, half of them mirrored.
  static void place(const Sample& sample, bool mirrored, float* row) {
    constexpr int kCells = Windows::kAcross * Windows::kUp;
    constexpr float kUnit = 1.0F / Windows::kOne;
    const std::int8_t* from = sample.inputs.data();
    if (!mirrored) {
      for (int i = 0; i < kInputs; ++i) row[i] = kUnit * from[i];
      return;
    }
    for (int cell = 0; cell < kCells; ++cell) {
      const int across = cell % Windows::kAcross;
      const int other = cell - across + Windows::kAcross - 1 - across;
      for (int c = 0; c < Windows::kChannels; ++c)
        row[cell * Windows::kChannels + c] = kUnit * from[other * Windows::kChannels + c];
    }
    for (int i = kCells * Windows::kChannels; i < kInputs; ++i) row[i] = kUnit * from[i];
  }

  double step(const std::vector<Sample>& samples, std::span<const std::size_t> batch, float rate,
              Random& random) {
    std::array<bool, kBatch> mirrored;
    for (std::size_t i = 0; i < kBatch; ++i) {
      mirrored[i] = random.uniform() < 0.5;
      place(samples[batch[i]], mirrored[i], inputs_.data() + i * kInputs);
    }
    first_.forward(inputs_.transpose(), true);
    second_.forward(first_.sums, true);
    outputs_.forward(second_.sums, false);
    double loss = 0.0;
    slopes_.setZero(Network::kOutputs, kBatch);
    for (std::size_t k = 0; k < kBatch; ++k) {
      const Sample& sample = samples[batch[k]];
      const auto i = static_cast<Eigen::Index>(k);
      const float probability = 1.0F / (1.0F + std::exp(-outputs_.sums(0, i)));
      loss -= std::log(std::max(1e-7F, sample.person ? probability : 1.0F - probability));
      slopes_(0, i) = (probability - (sample.person ? 1.0F : 0.0F)) / kBatch;
      if (!sample.person) continue;
      const float wanted[2] = {sample.forward, mirrored[k] ? -sample.left : sample.left};
      for (int axis = 0; axis < 2; ++axis)
        slopes_(axis + 1, i) = kPlaceShare *
                               std::clamp(outputs_.sums(axis + 1, i) - wanted[axis], -1.0F, 1.0F) /
                               kBatch;
    }
    ++steps_;
    const float correction =
        std::sqrt(1.0F - std::pow(0.999F, float(steps_))) / (1.0F - std::pow(0.9F, float(steps_)));
    Matrix back = outputs_.backward(second_.sums, slopes_, true, rate, correction);
    back.array() *= (second_.sums.array() > 0.0F).cast<float>();
    back = second_.backward(first_.sums, back, true, rate, correction);
    back.array() *= (first_.sums.array() > 0.0F).cast<float>();
    first_.backward(inputs_.transpose(), back, false, rate, correction);
    return loss;
  }

  Random random_;
  TrainedLayer first_, second_, outputs_;
  long steps_ = 0;
  Matrix inputs_ = Matrix::Zero(kBatch, kInputs), slopes_;
};

constexpr std::array kThresholds{-1.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0};

/// The scores of unseen scenes at several thresholds.
std::array<Score, kThresholds.size()> test(const Network& network, Scenes& scenes, Camera camera,
                                           int count) {
  people_detector::DetectorConfig config;
  config.threshold = kThresholds.front();
  auto detector =
      people_detector::DepthDetector::make(scenes.intrinsics(camera), config, network).value();
  std::array<Score, kThresholds.size()> scores;
  for (int i = 0; i < count; ++i) {
    const auto shot = scenes.unseen(camera, i);
    const auto found = detector.find(shot.processed, shot.view).value();
    std::vector<people_detector::Sighting> sightings(found.begin(), found.end());
    for (std::size_t k = 0; k < scores.size(); ++k) {
      std::erase_if(sightings, [&](const auto& one) { return one.score < kThresholds[k]; });
      scores[k] += judge(sightings, shot.truths);
    }
  }
  return scores;
}

template <int kIn, int kNeurons>
void write(const people_detector::Layer<kIn, kNeurons>& layer, std::ofstream& file) {
  char text[64];
  for (const auto& neuron : layer.neurons) {
    file << "      {";
    for (std::size_t i = 0; i < neuron.weights.size(); ++i) {
      if (i % 44 == 0) file << (i > 0 ? "\"\n       \"" : "\"");
      std::snprintf(text, sizeof text, "%02x",
                    static_cast<unsigned>(static_cast<std::uint8_t>(neuron.weights[i])));
      file << text;
    }
    std::snprintf(text, sizeof text, "\",\n       %.9eF, %.9eF},\n",
                  static_cast<double>(neuron.scale), static_cast<double>(neuron.bias));
    file << text;
  }
}

/// Weights as two hexadecimal digits each, 44 to a line.
void write(const Network& network, const std::string& path) {
  std::ofstream file(path);
  file << "// Written by usher-train-people; see the component's README.\n"
          "#include \"perception/people_detector/core/network.hpp\"\n\n"
          "namespace usher::people_detector {\n\n"
          "const Network& trained_network() {\n"
          "  static constexpr WrittenNeuron kNeurons[] = {\n";
  write(network.first, file);
  write(network.second, file);
  write(network.outputs, file);
  file << "  };\n  static const Network network = decode(kNeurons);\n  return network;\n}\n\n"
          "}  // namespace usher::people_detector\n";
}

}  // namespace

int main(int argc, char** argv) {
  using usher::operations::within;
  CLI::App app("Trains the network of the people detector on random scenes");
  std::string out = "network_weights.cpp";
  int count = 20000, epochs = 12, rounds = 3, tests = 1000;
  bool trains = true;
  app.add_option("--out", out, "Where the network is written");
  app.add_option("--scenes", count, "New ones in each round")->check(within(10, 100000));
  app.add_option("--epochs", epochs, "Of each round")->check(within(1, 1000));
  app.add_option("--rounds", rounds, "Each takes what the one before it took wrongly for people")
      ->check(within(1, 10));
  app.add_option("--tests", tests, "Scenes that it is tested on")->check(within(1, 100000));
  app.add_flag("!--test-only", trains, "Tests the network that is built in");
  if (const auto ended = usher::operations::ended_by(app, argc, argv)) return *ended;
  std::vector<Sample> samples;
  Trainer trainer;
  Scenes scenes;
  auto network = std::make_unique<Network>();
  if (!trains) *network = people_detector::trained_network();
  for (int round = 0; trains && round < rounds; ++round) {
    std::fprintf(stderr, "round %d of %d\n", round + 1, rounds);
    collect(scenes, count, round > 0 ? network.get() : nullptr, round > 0 ? 0.02 : 0.12, samples);
    for (int i = 0; i < epochs; ++i)
      trainer.epoch(samples, 2e-3F * std::pow(0.02F, float(i) / float(epochs)),
                    static_cast<std::uint64_t>(i));
    *network = trainer.network();
    write(*network, out);
  }
  for (const Camera camera : {kKinect, kRear}) {
    std::printf("%s\n", camera == kRear ? "rear camera" : "Kinect");
    const auto scores = test(*network, scenes, camera, tests);
    for (std::size_t k = 0; k < scores.size(); ++k) {
      const Score& score = scores[k];
      std::printf("threshold %5.2f: recall %.4f precision %.4f error %.3f m (%d people)\n",
                  kThresholds[k], score.recall(), score.precision(),
                  score.error / std::max(1, score.found), score.found + score.missed);
    }
  }
  return 0;
}
