#include "interaction/speech/engine/espeak.hpp"
#include "interaction/speech/engine/pocketsphinx.hpp"
#include "interaction/speech/engine/sound_cards.hpp"
#include "interaction/speech/shell/component.hpp"
#include "interaction/speech/shell/stream_microphone.hpp"
#include "runtime/dds/component_main.hpp"

int main(int argc, char** argv) {
  using namespace usher;
  const runtime::ComponentFactory factory{
      "speech", [](runtime::Host& host) {
        speech::Equipment equipment{
            std::make_unique<speech::StreamMicrophone>(host, speech::make_sound_card()), nullptr,
            speech::make_pocketsphinx(speech::kSphinxModels)};
        auto voice = speech::make_espeak();
        if (!voice) host.fault(voice.error());
        equipment.synthesizer = std::move(voice).value();
        return std::unique_ptr<runtime::Component>(
            std::make_unique<speech::SpeechComponent>(host, std::move(equipment)));
      }};
  return runtime::component_main(factory, argc, argv);
}
