#include "runtime/dds/bytes_type.hpp"

#include <algorithm>

namespace usher::runtime {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

BytesType::BytesType(const std::string& wire_name) {
  setName(wire_name.c_str());
  // Histories grow to what is really sent (PREALLOCATED_WITH_REALLOC); this is only where they
  // start.
  m_typeSize = 256;
  m_isGetKeyDefined = false;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool BytesType::serialize(void* data, SerializedPayload_t* payload) {
  const auto& cdr = *static_cast<const std::span<const std::uint8_t>*>(data);
  if (cdr.size() > payload->max_size) return false;
  std::ranges::copy(cdr, payload->data);
  payload->length = static_cast<std::uint32_t>(cdr.size());
  payload->encapsulation = CDR_LE;
  return true;
}

bool BytesType::deserialize(SerializedPayload_t* payload, void* data) {
  static_cast<PayloadSink*>(data)->take({payload->data, payload->length});
  return true;
}

std::function<std::uint32_t()> BytesType::getSerializedSizeProvider(void* data) {
  return [data] {
    return static_cast<std::uint32_t>(
        static_cast<const std::span<const std::uint8_t>*>(data)->size());
  };
}

void* BytesType::createData() { return nullptr; }
void BytesType::deleteData(void*) {}
bool BytesType::getKey(void*, InstanceHandle_t*, bool) { return false; }

}  // namespace usher::runtime
