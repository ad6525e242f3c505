#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "foundation/random/random.hpp"
#include "idl/topics.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"
#include "vectors.hpp"

namespace usher::runtime {
namespace {

using test::bytes;

std_msgs::msg::Header header(const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp().sec(1700000000);
  header.stamp().nanosec(250000000);
  header.frame_id(frame);
  return header;
}

template <class Message>
Bytes encode(const Message& message) {
  Bytes cdr;
  EXPECT_TRUE(message_type<Message>().serialize(&message, cdr));
  return cdr;
}

template <class Message>
std::shared_ptr<const Message> decode(std::span<const std::uint8_t> cdr) {
  return std::static_pointer_cast<const Message>(message_type<Message>().deserialize(cdr));
}

/// The published bytes, byte for byte (our padding is zero as theirs), and back.
template <class Message>
void expect_vector(const Message& message, std::string_view vector) {
  const Bytes expected = bytes(vector);
  EXPECT_EQ(encode(message), expected) << message_type<Message>().name;
  const auto decoded = decode<Message>(expected);
  ASSERT_NE(decoded, nullptr) << message_type<Message>().name;
  EXPECT_EQ(encode(*decoded), expected) << message_type<Message>().name;
}

TEST(MessageTypes, HaveTheNamesOfRos2) {
  EXPECT_EQ(message_type<sensor_msgs::msg::LaserScan>().name, "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(message_type<usher_msgs::msg::DriveCommand>().name,
            "usher_msgs::msg::dds_::DriveCommand_");
  EXPECT_EQ(message_type_by_name("tf2_msgs::msg::dds_::TFMessage_"),
            &message_type<tf2_msgs::msg::TFMessage>());
  EXPECT_EQ(message_type_by_name("tf2_msgs::msg::TFMessage"), nullptr);
}

TEST(MessageTypes, KnowEveryTopicOfTheCatalogue) {
  std::size_t count = 0;
  const auto check = [&](std::string_view topic) {
    ++count;
    EXPECT_NE(message_type_by_topic(topic), nullptr) << topic;
  };
  std::apply([&](const auto&... topic) { (check(topic.name), ...); }, topics::kAll);
  EXPECT_GT(count, 50U);
  EXPECT_EQ(message_type_by_topic("scan"), &message_type<sensor_msgs::msg::LaserScan>());
  EXPECT_EQ(message_type_by_topic("rt/scan"), nullptr);
  EXPECT_EQ(message_type_by_topic(""), nullptr);
}

TEST(MessageTypes, EncodeHeadersAndTwistsAsRos2) {
  expect_vector(header("base_link"), test::kHeaderVector);
  geometry_msgs::msg::TwistStamped twist;
  twist.header(header("base_link"));
  twist.twist().linear().x(0.5);
  twist.twist().angular().z(-0.25);
  expect_vector(twist.twist(), test::kTwistVector);
  expect_vector(twist, test::kTwistStampedVector);
}

TEST(MessageTypes, EncodeSensorMessagesAsRos2) {
  sensor_msgs::msg::LaserScan scan;
  scan.header(header("laser"));
  scan.angle_min(-1.5F);
  scan.angle_max(1.5F);
  scan.angle_increment(1.5F);
  scan.scan_time(0.02F);
  scan.range_min(0.5F);
  scan.range_max(20.0F);
  scan.ranges({1.0F, 2.0F, std::numeric_limits<float>::infinity()});
  expect_vector(scan, test::kLaserScanVector);

  sensor_msgs::msg::Joy joy;
  joy.header(header("joy"));
  joy.axes({0.0F, -1.0F});
  joy.buttons({1, 0, 0});
  expect_vector(joy, test::kJoyVector);

  sensor_msgs::msg::Range range;
  range.header(header("us0"));
  range.field_of_view(0.5F);
  range.min_range(0.25F);
  range.max_range(6.0F);
  range.range(1.5F);
  expect_vector(range, test::kRangeVector);
}

TEST(MessageTypes, EncodeMapsAndTransformsAsRos2) {
  nav_msgs::msg::OccupancyGrid grid;
  grid.header(header("map"));
  grid.info().map_load_time(header("").stamp());
  grid.info().resolution(0.05F);
  grid.info().width(2);
  grid.info().height(2);
  grid.info().origin().position().x(-1.0);
  grid.info().origin().position().y(-2.0);
  grid.data({0, 100, -1, 0});
  expect_vector(grid, test::kOccupancyGridVector);

  geometry_msgs::msg::TransformStamped transform;
  transform.header(header("odom"));
  transform.child_frame_id("base_link");
  transform.transform().translation().x(1.0);
  transform.transform().translation().y(2.0);
  tf2_msgs::msg::TFMessage tf;
  tf.transforms({transform});
  expect_vector(tf, test::kTransformVector);
}

TEST(MessageTypes, EncodeTheRestAsRos2) {
  diagnostic_msgs::msg::KeyValue value;
  value.key("k");
  value.value("v");
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(1);
  status.name("a");
  status.message("b");
  status.hardware_id("c");
  status.values({value});
  diagnostic_msgs::msg::DiagnosticArray diagnostics;
  diagnostics.header(header(""));
  diagnostics.status({status});
  expect_vector(diagnostics, test::kDiagnosticsVector);

  action_msgs::msg::GoalStatus goal;
  for (std::uint8_t i = 0; i < 16; ++i) goal.goal_info().goal_id().uuid()[i] = i;
  goal.goal_info().stamp(header("").stamp());
  goal.status(4);
  action_msgs::msg::GoalStatusArray goals;
  goals.status_list({goal});
  expect_vector(goals, test::kGoalStatusVector);

  rosgraph_msgs::msg::Clock clock;
  clock.clock(header("").stamp());
  expect_vector(clock, test::kClockVector);
  expect_vector(std_msgs::msg::Empty{}, test::kEmptyVector);
}

TEST(MessageTypes, ReplaceTheContentOfTheBufferAndZeroThePadding) {
  Bytes cdr(4000, 0xff);
  const std_msgs::msg::Header message = header("base_link");
  ASSERT_TRUE(message_type<std_msgs::msg::Header>().serialize(&message, cdr));
  EXPECT_EQ(cdr, bytes(test::kHeaderVector));

  usher_msgs::msg::DriveGrant grant;  // has a boolean before a float
  Bytes dirty(4000, 0xff);
  ASSERT_TRUE(message_type<usher_msgs::msg::DriveGrant>().serialize(&grant, dirty));
  EXPECT_THAT(std::span(dirty).subspan(4, dirty.size() - 9), testing::Each(0));
}

TEST(MessageTypes, AcceptBigEndian) {
  const auto decoded = decode<std_msgs::msg::Header>(
      bytes("00 00 00 00 65 53 f1 00 0e e6 b2 80 00 00 00 04 6d 61 70 00"));
  ASSERT_NE(decoded, nullptr);
  EXPECT_EQ(decoded->stamp().sec(), 1700000000);
  EXPECT_EQ(decoded->stamp().nanosec(), 250000000U);
  EXPECT_EQ(decoded->frame_id(), "map");
}

TEST(MessageTypes, RefuseOtherEncapsulations) {
  for (const int kind : {2, 3, 6, 7, 8, 9, 10, 11, 255}) {
    Bytes cdr = bytes(test::kHeaderVector);
    cdr[1] = static_cast<std::uint8_t>(kind);
    EXPECT_EQ(decode<std_msgs::msg::Header>(cdr), nullptr) << kind;
  }
  Bytes cdr = bytes(test::kHeaderVector);
  cdr[0] = 1;
  EXPECT_EQ(decode<std_msgs::msg::Header>(cdr), nullptr);
}

TEST(MessageTypes, RefuseEveryTruncation) {
  for (const std::string_view vector :
       {test::kTransformVector, test::kDiagnosticsVector, test::kLaserScanVector}) {
    const Bytes cdr = bytes(vector);
    const MessageType& type =
        vector == test::kTransformVector     ? message_type<tf2_msgs::msg::TFMessage>()
        : vector == test::kDiagnosticsVector ? message_type<diagnostic_msgs::msg::DiagnosticArray>()
                                             : message_type<sensor_msgs::msg::LaserScan>();
    for (std::size_t size = 0; size < cdr.size(); ++size) {
      EXPECT_EQ(type.deserialize(std::span(cdr).first(size)), nullptr) << type.name << ' ' << size;
    }
    EXPECT_NE(type.deserialize(cdr), nullptr);
  }
}

TEST(MessageTypes, AcceptPaddingAtTheEndButNoMore) {
  Bytes cdr = bytes(test::kHeaderVector);
  for (int padding = 1; padding <= 3; ++padding) {
    cdr.push_back(0);
    EXPECT_NE(decode<std_msgs::msg::Header>(cdr), nullptr) << padding;
  }
  cdr.push_back(0);
  EXPECT_EQ(decode<std_msgs::msg::Header>(cdr), nullptr);
}

TEST(MessageTypes, RefuseAbsurdLengths) {
  // A count of 4 billion transforms, of 4 billion ranges, and a count that the remaining bytes
  // could only hold at one byte an element.
  EXPECT_EQ(decode<tf2_msgs::msg::TFMessage>(bytes("00 01 00 00 ff ff ff ff 00 00 00 00")),
            nullptr);
  Bytes scan = bytes(test::kLaserScanVector);
  for (std::size_t i = 52; i < 56; ++i) scan[i] = 0xff;
  EXPECT_EQ(decode<sensor_msgs::msg::LaserScan>(scan), nullptr);
  Bytes crowded = bytes("00 01 00 00 40 9c 00 00");
  crowded.resize(8 + 40000);
  EXPECT_EQ(decode<tf2_msgs::msg::TFMessage>(crowded), nullptr);
  Bytes text = bytes(test::kHeaderVector);
  text[15] = 0x80;
  EXPECT_EQ(decode<std_msgs::msg::Header>(text), nullptr);
}

TEST(MessageTypes, RefuseBooleansThatAreNone) {
  usher_msgs::msg::Whiskers whiskers;
  Bytes cdr = encode(whiskers);
  cdr.back() = 2;
  EXPECT_EQ(decode<usher_msgs::msg::Whiskers>(cdr), nullptr);
}

TEST(MessageTypes, TakeAStringWithoutTerminatorAsItIs) {
  const auto decoded = decode<std_msgs::msg::String>(bytes("00 01 00 00 02 00 00 00 61 62"));
  ASSERT_NE(decoded, nullptr);
  EXPECT_EQ(decoded->data(), "ab");
  const auto empty = decode<std_msgs::msg::String>(bytes("00 01 00 00 00 00 00 00"));
  ASSERT_NE(empty, nullptr);
  EXPECT_EQ(empty->data(), "");
}

TEST(MessageTypes, FindTheStamp) {
  const Time expected{Duration{1'700'000'000'250'000'000}};
  geometry_msgs::msg::TwistStamped twist;
  twist.header(header("x"));
  EXPECT_EQ(message_type<geometry_msgs::msg::TwistStamped>().stamp(&twist), expected);
  usher_msgs::msg::DriveCommand command;
  command.stamp(header("").stamp());
  EXPECT_EQ(message_type<usher_msgs::msg::DriveCommand>().stamp(&command), expected);
  const tf2_msgs::msg::TFMessage tf;
  EXPECT_EQ(message_type<tf2_msgs::msg::TFMessage>().stamp(&tf), std::nullopt);
  const std_msgs::msg::String text;
  EXPECT_EQ(message_type<std_msgs::msg::String>().stamp(&text), std::nullopt);
}

TEST(MessageTypes, SurviveRandomBytes) {
  // Two thirds of the inputs are damaged messages, which get deeper than noise does.
  const std::vector<Bytes> seeds = {bytes(test::kTransformVector), bytes(test::kDiagnosticsVector),
                                    bytes(test::kLaserScanVector),
                                    bytes(test::kOccupancyGridVector)};
  Random random(20261121);
  std::size_t accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes cdr(random.below(200));
    if (round % 3 != 0) {
      cdr = seeds[random.below(seeds.size())];
      for (std::uint64_t i = random.below(4); i > 0; --i) {
        cdr[random.below(cdr.size())] = static_cast<std::uint8_t>(random.next());
      }
    } else {
      for (std::uint8_t& byte : cdr) byte = static_cast<std::uint8_t>(random.next());
      if (cdr.size() > 2) cdr[0] = 0, cdr[1] &= 1;
    }
    std::apply(
        [&](const auto&... topic) {
          ((accepted += message_type_by_topic(topic.name)->deserialize(cdr) != nullptr ? 1U : 0U),
           ...);
        },
        topics::kAll);
  }
  EXPECT_GT(accepted, 1000U);  // the damage is not so great that nothing is left to decode
}

}  // namespace
}  // namespace usher::runtime
