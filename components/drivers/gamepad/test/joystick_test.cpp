#include "drivers/gamepad/core/joystick.hpp"

#include <gmock/gmock.h>

#include "foundation/random/random.hpp"

namespace usher::gamepad {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using Bytes = std::vector<std::uint8_t>;

TEST(Joystick, ReadsRecordedEvents) {
  Joystick pad;
  // Axis 1 half forward: Linux counts forward negative.
  EXPECT_TRUE(pad.received(Bytes{0x68, 0xE4, 0x01, 0x00, 0x00, 0xC0, 0x02, 0x01}));
  EXPECT_THAT(pad.axes(), ElementsAre(0.0F, FloatNear(0.5F, 0.001F)));
  EXPECT_TRUE(pad.received(Bytes{0x60, 0xE4, 0x01, 0x00, 0x01, 0x00, 0x01, 0x05}));
  EXPECT_THAT(pad.buttons(), ElementsAre(0, 0, 0, 0, 0, 1));
  EXPECT_FALSE(pad.received(Bytes{0x60, 0xE4, 0x01, 0x00, 0x01, 0x00, 0x01, 0x05}))
      << "nothing new";
}

TEST(Joystick, TakesTheInitialState) {
  Joystick pad;
  EXPECT_FALSE(pad.received(Bytes{0xB7, 0xED, 0x0E, 0x12, 0x00, 0x00, 0x81, 0x00}));
  EXPECT_THAT(pad.buttons(), ElementsAre(0));
  EXPECT_TRUE(pad.received(Bytes{0x40, 0xE2, 0x01, 0x00, 0x01, 0x80, 0x82, 0x02}));
  EXPECT_THAT(pad.axes(), ElementsAre(0.0F, 0.0F, 1.0F)) << "a released trigger";
}

TEST(Joystick, PartsOfRecordsWaitForTheRest) {
  const Bytes record{0x68, 0xE4, 0x01, 0x00, 0x01, 0x80, 0x02, 0x00};
  for (std::size_t cut = 1; cut < record.size(); ++cut) {
    Joystick pad;
    EXPECT_FALSE(pad.received(std::span(record).first(cut)));
    EXPECT_TRUE(pad.received(std::span(record).subspan(cut)));
    EXPECT_THAT(pad.axes(), ElementsAre(1.0F));
  }
}

TEST(Joystick, CountsWhatMakesNoSense) {
  Joystick pad;
  EXPECT_FALSE(pad.received(Bytes{0, 0, 0, 0, 2, 0, 0x01, 0}));    // a button of 2
  EXPECT_FALSE(pad.received(Bytes{0, 0, 0, 0, 1, 0, 0x01, 200}));  // too many
  EXPECT_FALSE(pad.received(Bytes{0, 0, 0, 0, 1, 0, 0x07, 0}));    // another type
  EXPECT_EQ(pad.rejected(), 3U);
  EXPECT_TRUE(pad.buttons().empty());
}

TEST(Joystick, ForgetsAPadThatIsGone) {
  Joystick pad;
  pad.received(Bytes{0, 0, 0, 0, 1, 0, 0x01, 4, 0, 0});
  pad.reset();
  EXPECT_TRUE(pad.buttons().empty());
  EXPECT_TRUE(pad.received(Bytes{0, 0, 0, 0, 1, 0, 0x01, 0})) << "the half record is gone too";
}

Bytes axis(std::uint8_t number, std::int16_t value) {
  const auto raw = static_cast<std::uint16_t>(value);
  return {
      0, 0,     0, 0, static_cast<std::uint8_t>(raw & 0xFF), static_cast<std::uint8_t>(raw >> 8),
      2, number};
}
Bytes button(std::uint8_t number, bool down) {
  return {0, 0, 0, 0, static_cast<std::uint8_t>(down), 0, 1, number};
}

TEST(Joystick, AHeldButtonThatIsLetGoCountsAgainWhenItIsPressedAnew) {
  Joystick pad;
  pad.received(axis(1, 0));
  pad.received(axis(1, -16000));
  pad.received(button(0, true));
  EXPECT_TRUE(pad.let_go());
  EXPECT_THAT(pad.buttons(), ElementsAre(0));
  EXPECT_FALSE(pad.let_go()) << "none is held";
  EXPECT_TRUE(pad.received(axis(1, -20000)));
  EXPECT_FALSE(pad.received(button(0, true))) << "described again, not pressed anew";
  EXPECT_THAT(pad.buttons(), ElementsAre(0));
  EXPECT_FALSE(pad.received(button(0, false)));
  EXPECT_TRUE(pad.received(button(0, true)));
  EXPECT_THAT(pad.buttons(), ElementsAre(1));
  EXPECT_EQ(pad.records(), 7U);
}

TEST(Joystick, LetsGoOnlyWhileAStickIsOutOfItsMiddle) {
  Joystick pad;
  pad.received(axis(1, 0));
  pad.received(axis(2, -32767));  // a trigger that rests at its end
  pad.received(button(4, true));
  EXPECT_FALSE(pad.let_go());
  pad.received(axis(1, 3000));
  EXPECT_FALSE(pad.let_go()) << "hardly moved";
  pad.received(axis(1, 32767));
  EXPECT_TRUE(pad.let_go());
  pad.received(button(4, false));
  pad.received(button(4, true));
  pad.received(axis(1, 0));
  EXPECT_FALSE(pad.let_go());
  pad.received(axis(2, 0));
  pad.received(axis(2, -32767));
  EXPECT_TRUE(pad.let_go()) << "a trigger that moves may be a stick that drives";
  pad.reset();
  EXPECT_FALSE(pad.let_go());
}

TEST(Joystick, StaysWithinItsBoundsOnNoise) {
  Random random(1);
  Joystick pad;
  for (int i = 0; i < 100000; ++i) {
    const auto byte = static_cast<std::uint8_t>(random.below(256));
    pad.received({&byte, 1});
    if (i % 1000 == 0) pad.let_go();
  }
  EXPECT_LE(pad.axes().size(), Joystick::kMostAxes);
  EXPECT_LE(pad.buttons().size(), Joystick::kMostButtons);
  for (const float axis : pad.axes()) EXPECT_LE(std::abs(axis), 1.0F);
}

}  // namespace
}  // namespace usher::gamepad
