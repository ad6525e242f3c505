#include "drivers/torso/core/protocol.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"
#include "support/bytes.hpp"

namespace usher::torso {
namespace {

using geometry::radians;
using test::Bytes;
using test::hex;

Bytes content_of(const serial_frame::Frame& frame) {
  serial_frame::FrameDecoder decoder;
  Bytes result;
  decoder.feed(frame.span(), [&](std::span<const std::uint8_t> content) {
    result.assign(content.begin(), content.end());
  });
  return result;
}

TorsoFrame example() {
  return {{radians(10.0), radians(-10.0), radians(2.5), 0.05, 0.0, radians(-0.01), radians(180.0)},
          {1.0F, 0.0F, 0.0F},
          {0.0F, 0.2F, 1.0F}};
}

TEST(Protocol, WritesFieldsInStepsOfAHundredthDegreeAndATenthMillimeter) {
  // 1000 = 03E8, -1000 = FC18, 250 = 00FA, 500 = 01F4, 0, -1 = FFFF, 18000 = 4650; 0.2 = 51 = 33.
  EXPECT_EQ(hex(content_of(set_frame(7, example()))),
            "30 07 E8 03 18 FC FA 00 F4 01 00 00 FF FF 50 46 FF 00 00 00 33 FF");
}

TEST(Protocol, ReadsWhatItWrites) {
  const State state{123456, example(), kServosOff | kJointStuck};
  const auto said = parse(content_of(to_frame({10, state})));
  ASSERT_TRUE(said);
  EXPECT_EQ(said->sequence, 10);
  const State& read = said->state;
  EXPECT_EQ(read.time_ms, 123456U);
  EXPECT_EQ(read.status, kServosOff | kJointStuck);
  const auto command = parse_command(content_of(set_frame(0, example())));
  ASSERT_TRUE(command);
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i) {
    EXPECT_NEAR(read.frame.joints[i], example().joints[i], 1e-9) << i;
    EXPECT_NEAR(command->joints[i], example().joints[i], 1e-9) << i;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(read.frame.left_eye[i], example().left_eye[i], 0.002) << i;
    EXPECT_NEAR(command->right_eye[i], example().right_eye[i], 0.002) << i;
  }
}

TEST(Protocol, RefusesUnknownTypesAndWrongLengths) {
  const Bytes state = content_of(to_frame({1, State{}}));
  ASSERT_TRUE(parse(state));
  Bytes longer = state, shorter = state;
  longer.push_back(0);
  shorter.pop_back();
  EXPECT_FALSE(parse(longer));
  EXPECT_FALSE(parse(shorter));
  for (int type = 0; type < 256; ++type) {
    Bytes other = state;
    other[0] = static_cast<std::uint8_t>(type);
    EXPECT_EQ(parse(other).has_value(), type == 0x31) << type;
  }
  EXPECT_FALSE(parse({}));
  EXPECT_FALSE(parse_command(state));
  EXPECT_FALSE(parse_command({}));
}

TEST(Protocol, RefusesAJointThatStandsWhereNoneCan) {
  struct Row {
    std::size_t joint;
    int steps;
    bool possible;
  };
  const Row rows[] = {{0, 18000, true},  {0, 18001, false}, {6, -18000, true}, {6, -18001, false},
                      {3, 10000, true},  {3, 10001, false}, {3, -10000, true}, {3, -10001, false},
                      {1, 32767, false}, {1, -32768, false}};
  for (const Row& row : rows) {
    Bytes state = content_of(to_frame({1, State{}}));
    state[6 + 2 * row.joint] = static_cast<std::uint8_t>(row.steps);
    state[7 + 2 * row.joint] = static_cast<std::uint8_t>(row.steps >> 8);
    EXPECT_EQ(parse(state).has_value(), row.possible) << row.joint << ": " << row.steps;
  }
}

TEST(Protocol, ClipsWhatDoesNotFitAndDarkensWhatIsNoColor) {
  TorsoFrame frame;
  frame.joints = {9.0, -9.0, 0, 7.0, 0, 0, 0};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.left_eye = {nan, -3.0F, 7.0F};
  const auto read = parse_command(content_of(set_frame(0, frame)));
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->joints[0], geometry::kPi, 1e-9);
  EXPECT_NEAR(read->joints[1], -geometry::kPi, 1e-9);
  EXPECT_NEAR(read->joints[3], 1.0, 1e-9);
  EXPECT_EQ(read->left_eye, (kinematics::EyeColor{0, 0, 1}));
}

TEST(Protocol, SurvivesAnyContent) {
  Random random(5);
  for (int run = 0; run < 20000; ++run) {
    Bytes content(random.below(40));
    for (auto& byte : content) byte = static_cast<std::uint8_t>(random.below(256));
    if (!content.empty() && random.below(2) == 0) content[0] = 0x31;
    const auto message = parse(content);
    if (!message) continue;
    EXPECT_TRUE(kinematics::finite(message->state.frame.joints));
  }
}

}  // namespace
}  // namespace usher::torso
