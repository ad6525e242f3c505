#include <optional>

#include "interaction/speech/core/grammar.hpp"
#include "interaction/speech/core/resample.hpp"
#include "interaction/speech/engine/espeak.hpp"
#include "runtime/dds/component_main.hpp"
#include "simulation/visitor/core/mouth.hpp"
#include "simulation/visitor/shell/component.hpp"

namespace {

using namespace usher;

/// Another person than the robot, by the same engine; made when it is first needed.
class EspeakVoice final : public visitor::Voice {
 public:
  Result<std::vector<std::int16_t>> say(const std::string& words) override {
    if (engine_ == nullptr) {
      auto made = speech::make_espeak();
      if (!made) return Error{made.error()};
      engine_ = std::move(made).value();
    }
    speech::Synthesizer::Settings settings;
    settings.voice = "f2";
    auto said = engine_->say(speech::spoken_words(words), "en", settings);
    if (!said) return Error{said.error()};
    return speech::resampled(said->sound, visitor::Mouth::kMouthRate).samples;
  }

 private:
  std::unique_ptr<speech::Synthesizer> engine_;
};

}  // namespace

int main(int argc, char** argv) {
  const runtime::ComponentFactory factory{
      "visitor", [](runtime::Host& host) {
        return std::unique_ptr<runtime::Component>(
            std::make_unique<visitor::VisitorComponent>(host, std::make_shared<EspeakVoice>()));
      }};
  return runtime::component_main(factory, argc, argv);
}
