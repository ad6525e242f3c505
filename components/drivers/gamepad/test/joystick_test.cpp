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

TEST(Joystick, StaysWithinItsBoundsOnNoise) {
  Random random(1);
  Joystick pad;
  for (int i = 0; i < 100000; ++i) {
    const auto byte = static_cast<std::uint8_t>(random.below(256));
    pad.received({&byte, 1});
  }
  EXPECT_LE(pad.axes().size(), Joystick::kMostAxes);
  EXPECT_LE(pad.buttons().size(), Joystick::kMostButtons);
  for (const float axis : pad.axes()) EXPECT_LE(std::abs(axis), 1.0F);
}

}  // namespace
}  // namespace usher::gamepad
