#include "runtime/parameters/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace usher::runtime {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Units, DecimalMultiplesGiveTheSameDoubleAsSi) {
  EXPECT_EQ(to_si(470, "mm", "m"), 0.47);
  EXPECT_EQ(to_si(47, "cm", "m"), 0.47);
  EXPECT_EQ(to_si(0.0047, "km", "m"), 4.7);
  EXPECT_EQ(to_si(20, "ms", "s"), 0.02);
  EXPECT_EQ(to_si(35, "us", "s"), 35e-6);
  EXPECT_EQ(to_si(2, "min", "s"), 120.0);
  for (int i = 1; i < 10000; ++i) {
    const double metres = std::stod(std::to_string(i) + "e-3");
    EXPECT_EQ(to_si(i, "mm", "m"), metres) << i;
  }
}

TEST(Units, DegreesComeBackAsTheyWereWritten) {
  for (int tenths = 1; tenths <= 3600; ++tenths) {
    const double degrees = tenths / 10.0;
    const double radians = to_si(degrees, "deg", "rad").value();
    EXPECT_NEAR(radians, degrees * std::numbers::pi / 180, 1e-15);
    EXPECT_EQ(with_unit(radians, "rad"), shortest(degrees) + " deg");
  }
  EXPECT_EQ(with_unit(to_si(-30, "deg/s", "rad/s").value(), "rad/s"), "-30 deg/s");
  EXPECT_EQ(with_unit(0.5, "rad"), "0.5 rad");
}

TEST(Units, AnotherQuantityIsNoConversion) {
  EXPECT_FALSE(to_si(5, "kg", "m"));
  EXPECT_FALSE(to_si(5, "deg", "rad/s"));
  EXPECT_FALSE(to_si(5, "parsec", "m"));
  EXPECT_FALSE(to_si(5, "m", "-"));
  EXPECT_FALSE(is_si("mm"));
  EXPECT_FALSE(is_si(""));
  EXPECT_TRUE(is_si("m/s2"));
  EXPECT_EQ(units_of("m"), "m, mm, cm, km");
}

TEST(ReadNumber, TakesANumberAndItsUnit) {
  const auto check = [](const char* text, double value, const char* unit) {
    const auto number = read_number(text);
    ASSERT_TRUE(number) << text;
    EXPECT_EQ(number->value, value) << text;
    EXPECT_EQ(number->unit, unit) << text;
  };
  check("0.47", 0.47, "");
  check("0.47 m", 0.47, "m");
  check("470mm", 470, "mm");
  check(" -1e-3  m/s ", -1e-3, "m/s");
  check("+5", 5, "");
  check(".5", 0.5, "");
  check(".inf", kInfinity, "");
  check("-.inf", -kInfinity, "");
  check("inf m", kInfinity, "m");
  check("0", 0, "");
  check("-0.0 V", 0, "V");
}

TEST(ReadNumber, RefusesWhatIsNone) {
  for (const char* text : {"", " ", "m", "nan", ".nan", "-nan", "--5", "+-5", "e5", "-", "infantry",
                           "inf inity x", "1e999", "."}) {
    const auto number = read_number(text);
    // "infantry" reads as infinite antries: the unit is what is refused there.
    EXPECT_TRUE(!number || !to_si(number->value, number->unit, "m")) << text;
  }
  EXPECT_EQ(read_number("0x10")->unit, "x10");  // no hexadecimal
}

}  // namespace
}  // namespace usher::runtime
