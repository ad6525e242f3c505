// libFuzzer target: every message type and the printer on arbitrary bytes. The first byte chooses
// the type.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::runtime;
  static const std::vector<const MessageType*> types = std::apply(
      [](const auto&... topic) {
        return std::vector<const MessageType*>{message_type_by_topic(topic.name)...};
      },
      usher::topics::kAll);
  if (size == 0) return 0;
  const MessageType& type = *types[data[0] % types.size()];
  const std::span cdr(data + 1, size - 1);
  const auto message = type.deserialize(cdr);
  const MessageLayout& layout = *MessageLayouts::built_in().find(type.name);
  to_yaml(layout, cdr, 4);
  if (message != nullptr) {
    // What was accepted can be written, and what was written is accepted.
    Bytes again;
    if (!type.serialize(message.get(), again) || type.deserialize(again) == nullptr) std::abort();
    type.stamp(message.get());
  }
  return 0;
}
