#include "runtime/dds/message_types.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <array>
#include <cassert>
#include <concepts>
#include <map>
#include <new>
#include <tuple>
#include <utility>

#include "idl/topics.hpp"
#include "runtime/dds/message_layout.hpp"

// Every type that a topic carries, and the standard ones that tools and tests exchange.
#define USHER_MESSAGE_TYPES(TYPE)                     \
  TYPE(std_msgs::msg::Header)                         \
  TYPE(std_msgs::msg::Empty)                          \
  TYPE(std_msgs::msg::String)                         \
  TYPE(rosgraph_msgs::msg::Clock)                     \
  TYPE(geometry_msgs::msg::Twist)                     \
  TYPE(geometry_msgs::msg::TwistStamped)              \
  TYPE(geometry_msgs::msg::PoseStamped)               \
  TYPE(geometry_msgs::msg::PoseArray)                 \
  TYPE(geometry_msgs::msg::PoseWithCovarianceStamped) \
  TYPE(geometry_msgs::msg::TransformStamped)          \
  TYPE(geometry_msgs::msg::PolygonStamped)            \
  TYPE(sensor_msgs::msg::Image)                       \
  TYPE(sensor_msgs::msg::CameraInfo)                  \
  TYPE(sensor_msgs::msg::LaserScan)                   \
  TYPE(sensor_msgs::msg::Joy)                         \
  TYPE(sensor_msgs::msg::Range)                       \
  TYPE(sensor_msgs::msg::BatteryState)                \
  TYPE(nav_msgs::msg::OccupancyGrid)                  \
  TYPE(nav_msgs::msg::Odometry)                       \
  TYPE(nav_msgs::msg::Path)                           \
  TYPE(tf2_msgs::msg::TFMessage)                      \
  TYPE(diagnostic_msgs::msg::DiagnosticArray)         \
  TYPE(action_msgs::msg::GoalStatusArray)             \
  TYPE(usher_msgs::msg::Heartbeat)                    \
  TYPE(usher_msgs::msg::BaseStatus)                   \
  TYPE(usher_msgs::msg::DriveCommand)                 \
  TYPE(usher_msgs::msg::DriveGrant)                   \
  TYPE(usher_msgs::msg::BaseRequest)                  \
  TYPE(usher_msgs::msg::Whiskers)                     \
  TYPE(usher_msgs::msg::CameraTilt)                   \
  TYPE(usher_msgs::msg::MovementEnable)               \
  TYPE(usher_msgs::msg::MovementStatus)               \
  TYPE(usher_msgs::msg::FaceTarget)                   \
  TYPE(usher_msgs::msg::InteractionStatus)            \
  TYPE(usher_msgs::msg::TorsoFrame)                   \
  TYPE(usher_msgs::msg::TorsoStatus)                  \
  TYPE(usher_msgs::msg::People)                       \
  TYPE(usher_msgs::msg::PersonAhead)                  \
  TYPE(usher_msgs::msg::Faces)                        \
  TYPE(usher_msgs::msg::SupervisorStatus)             \
  TYPE(usher_msgs::msg::SupervisorRequest)            \
  TYPE(usher_msgs::msg::LocalizationStatus)           \
  TYPE(usher_msgs::msg::Costmap)                      \
  TYPE(usher_msgs::msg::CostmapRequest)               \
  TYPE(usher_msgs::msg::GoalCancel)                   \
  TYPE(usher_msgs::msg::ExploreGoal)                  \
  TYPE(usher_msgs::msg::ExploreStatus)                \
  TYPE(usher_msgs::msg::ExploreShare)                 \
  TYPE(usher_msgs::msg::FleetLook)                    \
  TYPE(usher_msgs::msg::FleetMeeting)                 \
  TYPE(usher_msgs::msg::MeetingRequest)               \
  TYPE(usher_msgs::msg::MeetingStatus)                \
  TYPE(usher_msgs::msg::MeetingReport)                \
  TYPE(usher_msgs::msg::PlanRequest)                  \
  TYPE(usher_msgs::msg::PlanReply)                    \
  TYPE(usher_msgs::msg::FollowGoal)                   \
  TYPE(usher_msgs::msg::FollowStatus)                 \
  TYPE(usher_msgs::msg::NavigateGoal)                 \
  TYPE(usher_msgs::msg::NavigateStatus)               \
  TYPE(usher_msgs::msg::Locations)                    \
  TYPE(usher_msgs::msg::DialogueScreen)               \
  TYPE(usher_msgs::msg::DialogueAnswer)               \
  TYPE(usher_msgs::msg::GuideStatus)                  \
  TYPE(usher_msgs::msg::GuideVisit)                   \
  TYPE(usher_msgs::msg::SpeechStatus)                 \
  TYPE(usher_msgs::msg::SpeechLevel)                  \
  TYPE(usher_msgs::msg::Visitor)                      \
  TYPE(usher_msgs::msg::NavigatePace)                 \
  TYPE(usher_sim_msgs::msg::BaseCommand)              \
  TYPE(usher_sim_msgs::msg::BaseFeedback)             \
  TYPE(usher_sim_msgs::msg::SensorBoardReading)       \
  TYPE(usher_sim_msgs::msg::TorsoCommand)             \
  TYPE(usher_sim_msgs::msg::TorsoReading)             \
  TYPE(usher_sim_msgs::msg::SensorBoardCommand)       \
  TYPE(usher_sim_msgs::msg::GroundTruth)              \
  TYPE(usher_sim_msgs::msg::PersonGoal)               \
  TYPE(usher_sim_msgs::msg::Sightings)                \
  TYPE(usher_sim_msgs::msg::FleetBody)                \
  TYPE(usher_sim_msgs::msg::FleetPeople)              \
  TYPE(usher_sim_msgs::msg::FleetPersonGoal)

namespace usher::runtime {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

/// "sensor_msgs::msg::LaserScan" -> "sensor_msgs::msg::dds_::LaserScan_", at compile time.
template <std::size_t Size>
struct WireName {
  explicit constexpr WireName(const char (&name)[Size]) {
    std::size_t last = 0;  // where the type's own name starts
    for (std::size_t i = 0; i + 1 < Size; ++i) {
      if (name[i] == ':') last = i + 1;
    }
    std::size_t at = 0;
    for (std::size_t i = 0; i < last; ++i) text[at++] = name[i];
    for (const char c : {'d', 'd', 's', '_', ':', ':'}) text[at++] = c;
    for (std::size_t i = last; i + 1 < Size; ++i) text[at++] = name[i];
    text[at] = '_';
  }
  constexpr std::string_view view() const { return {text.data(), text.size()}; }
  std::array<char, Size - 1 + 7> text{};
};

template <class Message>
bool serialize_message(const void* message, Bytes& cdr) {
  try {
    const auto& typed = *static_cast<const Message*>(message);
    cdr.assign(4 + Message::getCdrSerializedSize(typed),
               0);  // zeros: Fast CDR leaves padding as it finds it
    FastBuffer buffer(reinterpret_cast<char*>(cdr.data()), cdr.size());
    Cdr encoder(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
    encoder.serialize_encapsulation();
    typed.serialize(encoder);
    cdr.resize(encoder.getSerializedDataLength());
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
}

template <class Message>
const MessageLayout& layout_of(std::string_view name) {
  static const MessageLayout* layout = MessageLayouts::built_in().find(name);
  assert(layout != nullptr);
  return *layout;
}

/// Fast CDR resizes a sequence to the count that the bytes claim (bounded only by one byte an
/// element) before it reads it, so the lengths are judged first; after that it allocates what the
/// message really holds.
template <class Message>
std::shared_ptr<const void> deserialize_message(const MessageLayout& layout,
                                                std::span<const std::uint8_t> cdr) {
  if (!is_well_formed(layout, cdr)) return nullptr;
  try {
    auto message = std::make_shared<Message>();
    FastBuffer buffer(reinterpret_cast<char*>(const_cast<std::uint8_t*>(cdr.data())), cdr.size());
    Cdr decoder(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
    decoder.read_encapsulation();
    message->deserialize(decoder);
    return message;
  } catch (const std::bad_alloc&) {
    return nullptr;
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return nullptr;
  }
}

template <class T>
concept IsStamp = std::same_as<std::remove_cvref_t<T>, builtin_interfaces::msg::Time>;
template <class Message>
concept HasHeader = requires(const Message& message) {
  { message.header().stamp() } -> IsStamp;
};
template <class Message>
concept HasStamp = requires(const Message& message) {
  { message.stamp() } -> IsStamp;
};

Time time_of(const builtin_interfaces::msg::Time& stamp) {
  return Time(Duration(std::int64_t{stamp.sec()} * 1'000'000'000 + std::int64_t{stamp.nanosec()}));
}

template <class Message>
std::optional<Time> stamp_of(const void* message) {
  const auto& typed = *static_cast<const Message*>(message);
  if constexpr (HasHeader<Message>) return time_of(typed.header().stamp());
  if constexpr (HasStamp<Message>) return time_of(typed.stamp());
  return std::nullopt;
}

template <class... Message>
std::map<std::string_view, const MessageType*> by_topic(
    const std::tuple<const topics::Topic<Message>&...>& all) {
  std::map<std::string_view, const MessageType*> types;
  std::apply(
      [&](const auto&... topic) { (types.emplace(topic.name, &message_type<Message>()), ...); },
      all);
  return types;
}

}  // namespace

#define USHER_MESSAGE_TYPE(TYPE)                                                                  \
  template <>                                                                                     \
  const MessageType& message_type<TYPE>() {                                                       \
    static constexpr WireName kName(#TYPE);                                                       \
    static constexpr MessageType kType{kName.view(), &serialize_message<TYPE>,                    \
                                       [](std::span<const std::uint8_t> cdr) {                    \
                                         return deserialize_message<TYPE>(layout_of<TYPE>(#TYPE), \
                                                                          cdr);                   \
                                       },                                                         \
                                       &stamp_of<TYPE>};                                          \
    return kType;                                                                                 \
  }
USHER_MESSAGE_TYPES(USHER_MESSAGE_TYPE)
#undef USHER_MESSAGE_TYPE

const MessageType* message_type_by_topic(std::string_view topic) {
  static const std::map<std::string_view, const MessageType*> kTypes = by_topic(topics::kAll);
  const auto found = kTypes.find(topic);
  return found == kTypes.end() ? nullptr : found->second;
}

const MessageType* message_type_by_name(std::string_view wire_name) {
#define USHER_MESSAGE_TYPE(TYPE) &message_type<TYPE>(),
  static const std::array kTypes{USHER_MESSAGE_TYPES(USHER_MESSAGE_TYPE)};
#undef USHER_MESSAGE_TYPE
  for (const MessageType* type : kTypes) {
    if (type->name == wire_name) return type;
  }
  return nullptr;
}

}  // namespace usher::runtime
