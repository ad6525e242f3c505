#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace usher::runtime {

/// The value in `si` of a value written in `unit`; nothing when the unit is unknown or measures
/// something else. Exact in the sense that a decimal written in a decimal multiple gives the same
/// double as one written in SI (470 mm == 0.47 m), since powers of ten up to 1e22 and one division
/// are exact up to their rounding.
std::optional<double> to_si(double value, std::string_view unit, std::string_view si);

/// Whether parameters may be declared in it: m, rad, s, Hz, m/s, rad/s, m/s2, rad/s2, m/s3, rad/s3,
/// m2, kg, V, % and - for none.
bool is_si(std::string_view unit);

/// "m, mm, cm, km" for m: what may be written where `si` is declared.
std::string units_of(std::string_view si);

/// The shortest decimal that gives the same double; "inf" and "-inf".
std::string shortest(double value);

/// Value and unit as a person would write them: `0.47 m`, `20 deg` where that gives the same double
/// as the radians.
std::string with_unit(double value, std::string_view si);

/// A number that starts `text`, without sign games: "0.47", "-1e-3", "+5", ".inf"; nothing for NaN
/// and hexadecimal.
struct WrittenNumber {
  double value = 0.0;
  std::string_view unit;  ///< the rest without blanks around it; empty when there is none
};
std::optional<WrittenNumber> read_number(std::string_view text);

}  // namespace usher::runtime
