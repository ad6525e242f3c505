#pragma once

// Private to this folder: includes Fast DDS.

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <span>
#include <string>

namespace usher::runtime {

/// Takes the bytes of a received sample, in the middleware's thread; they are gone when the call
/// returns.
class PayloadSink {
 public:
  virtual ~PayloadSink() = default;
  virtual void take(std::span<const std::uint8_t> cdr) = 0;
};

/// Any message type, as Fast DDS sees it: bytes that we have encoded ourselves, without key. What
/// is written is a std::span<const std::uint8_t>, what receives is a PayloadSink.
class BytesType : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit BytesType(const std::string& wire_name);
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;
};

}  // namespace usher::runtime
