#include "interaction/speech/engine/sound_cards.hpp"

#include <alsa/asoundlib.h>

#include <array>

#include "interaction/speech/core/resample.hpp"
#include "interaction/speech/core/wav_file.hpp"

namespace usher::speech {

namespace {

constexpr unsigned kLatency = 200000;  // [us] of ALSA's buffer
constexpr double kAhead = 0.12;        // [s] that may wait in it
constexpr std::size_t kTicksPerSecond = 50;
constexpr double kLongestFile = 600.0;  // [s]

bool is_file(const std::string& device) { return device.ends_with(".wav"); }

/// ALSA prints what it also returns.
__attribute__((format(printf, 5, 6))) void say_nothing(const char*, int, const char*, int,
                                                       const char*, ...) {  // NOLINT: ALSA's type
}

/// SND_PCM_NONBLOCK: once it is open, it is only told and asked what the device does at once.
class Alsa {
 public:
  Alsa() = default;
  Alsa(const Alsa&) = delete;
  Alsa& operator=(const Alsa&) = delete;
  ~Alsa() { close(); }

  Status open(const std::string& device, snd_pcm_stream_t direction, int rate) {
    close();
    snd_lib_error_set_handler(say_nothing);
    int error = snd_pcm_open(&pcm_, device.c_str(), direction, SND_PCM_NONBLOCK);
    if (error >= 0) {
      error = snd_pcm_set_params(pcm_, SND_PCM_FORMAT_S16, SND_PCM_ACCESS_RW_INTERLEAVED, 1,
                                 static_cast<unsigned>(rate), 1, kLatency);
    } else {
      pcm_ = nullptr;
    }
    if (error >= 0 && direction == SND_PCM_STREAM_CAPTURE) error = snd_pcm_start(pcm_);
    if (error >= 0) return {};
    close();
    return Error{"expected the sound device '" + device + "', got: " + snd_strerror(error)};
  }
  void close() {
    if (pcm_ != nullptr) snd_pcm_close(pcm_);
    pcm_ = nullptr;
  }
  bool is_open() const { return pcm_ != nullptr; }

  std::uint64_t unheard() {
    snd_pcm_sframes_t delay = 0;
    if (pcm_ == nullptr || snd_pcm_delay(pcm_, &delay) < 0) return 0;
    return static_cast<std::uint64_t>(std::max<snd_pcm_sframes_t>(0, delay));
  }
  Status write(std::span<const std::int16_t> samples) {
    while (!samples.empty()) {
      snd_pcm_sframes_t done = snd_pcm_writei(pcm_, samples.data(), samples.size());
      if (done == -EAGAIN) return {};  // it has less room than it said: these are lost
      if (done == -ESTRPIPE) return gone(-ESTRPIPE);  // suspended: recovery would wait for it
      if (done < 0) done = snd_pcm_recover(pcm_, static_cast<int>(done), 1);
      if (done < 0) return gone(static_cast<int>(done));
      samples = samples.subspan(static_cast<std::size_t>(done));
      if (done == 0) return {};  // recovered from an underrun
    }
    return {};
  }
  Status read(std::vector<std::int16_t>& samples) {
    std::array<std::int16_t, 1024> part{};
    for (int i = 0; i < 16; ++i) {
      snd_pcm_sframes_t got = snd_pcm_readi(pcm_, part.data(), part.size());
      if (got == -EAGAIN || got == 0) return {};
      if (got == -ESTRPIPE) return gone(-ESTRPIPE);
      if (got < 0) {
        got = snd_pcm_recover(pcm_, static_cast<int>(got), 1);
        if (got >= 0) got = snd_pcm_start(pcm_);
        if (got < 0) return gone(static_cast<int>(got));
        return {};
      }
      samples.insert(samples.end(), part.begin(), part.begin() + got);
    }
    return {};
  }

 private:
  Status gone(int error) {
    close();
    return Error{std::string("the sound device is gone: ") + snd_strerror(error)};
  }
  snd_pcm_t* pcm_ = nullptr;
};

class Card final : public SoundCard {
 public:
  ~Card() override {
    if (!recorded_to_.empty()) static_cast<void>(write_wav_file(recorded_to_, recorded_).ok());
  }

  Opening to_open_loudspeaker(const std::string& device, int rate) override {
    return [this, device, rate] { return open_loudspeaker(device, rate); };
  }
  Opening to_open_microphone(const std::string& device) override {
    return [this, device] { return open_microphone(device); };
  }
  std::size_t room() override {
    const auto tick = static_cast<std::size_t>(rate_) / kTicksPerSecond;
    if (!loudspeaker_.is_open()) return tick;
    const auto most = static_cast<std::uint64_t>(kAhead * rate_);
    const std::uint64_t waits = loudspeaker_.unheard();
    return waits < most ? static_cast<std::size_t>(most - waits) : 0;
  }
  Status write(std::span<const std::int16_t> samples) override {
    if (loudspeaker_.is_open()) return loudspeaker_.write(samples);
    if (!recorded_to_.empty() && recorded_.duration() < kLongestFile)
      recorded_.samples.insert(recorded_.samples.end(), samples.begin(), samples.end());
    return {};
  }
  std::uint64_t unheard() override { return loudspeaker_.unheard(); }
  Status read(std::vector<std::int16_t>& samples) override {
    if (microphone_.is_open()) return microphone_.read(samples);
    if (!from_file_) return Error{"there is no microphone"};
    constexpr std::size_t kTick = kSpeechRate / kTicksPerSecond;
    for (std::size_t i = 0; i < kTick; ++i)
      samples.push_back(at_ < spoken_.samples.size() ? spoken_.samples[at_++] : std::int16_t{0});
    return {};
  }

 private:
  Status open_loudspeaker(const std::string& device, int rate) {
    rate_ = rate;
    recorded_.rate = rate;
    if (is_file(device)) recorded_to_ = device;
    if (device.empty() || device == "none" || is_file(device)) return {};
    return loudspeaker_.open(device, SND_PCM_STREAM_PLAYBACK, rate);
  }
  Status open_microphone(const std::string& device) {
    if (device.empty() || device == "none") return Error{"there is no microphone"};
    if (!is_file(device)) return microphone_.open(device, SND_PCM_STREAM_CAPTURE, kSpeechRate);
    auto sound = read_wav_file(device);
    if (!sound) return Error{sound.error()};
    spoken_ = for_recognizer(*sound);
    from_file_ = true;
    return {};
  }

  int rate_ = kSpeechRate;
  Alsa loudspeaker_, microphone_;
  bool from_file_ = false;
  Sound spoken_;
  std::size_t at_ = 0;
  Sound recorded_;
  std::string recorded_to_;
};

}  // namespace

std::unique_ptr<SoundCard> make_sound_card() { return std::make_unique<Card>(); }

}  // namespace usher::speech
