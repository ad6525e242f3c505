#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::runtime {

enum class FieldKind : std::uint8_t {
  kBool,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble,
  kString,
  kStruct
};

struct MessageLayout;

/// One member of a message as it lies on the wire.
struct FieldLayout {
  std::string name;
  FieldKind kind = FieldKind::kUint8;
  const MessageLayout* type = nullptr;  ///< of kStruct
  std::uint32_t count = 1;              ///< elements of a fixed array, 1 for a plain member
  bool sequence = false;                ///< a count on the wire instead
  bool array = false;
};

/// One structure of the IDL: its members in wire order.
struct MessageLayout {
  std::string name;  ///< "sensor_msgs::msg::LaserScan"
  std::vector<FieldLayout> fields;
};

/// The layouts of all structures of an IDL text, so that bytes from outside can be judged and
/// printed without a class for each type. Knows what idl/ uses: modules, structs, scalars, strings,
/// fixed arrays, unbounded sequences; constants and annotations are skipped. Anything else is an
/// error that names its line.
class MessageLayouts {
 public:
  static Result<MessageLayouts> parse(std::string_view idl);
  /// The IDL that this program was built from.
  static const MessageLayouts& built_in();

  /// By name in IDL ("sensor_msgs::msg::LaserScan") or on the wire
  /// ("sensor_msgs::msg::dds_::LaserScan_"); null when it is not there.
  const MessageLayout* find(std::string_view name) const;

 private:
  friend class IdlParser;
  std::map<std::string, std::unique_ptr<MessageLayout>, std::less<>> layouts_;
};

/// Whether the bytes (XCDR1 with encapsulation header, either byte order) are exactly one message
/// of this layout: every string and sequence lies within them, and at most three bytes of padding
/// follow. Allocates nothing; sequences of scalars cost the same at any length.
bool is_well_formed(const MessageLayout& layout, std::span<const std::uint8_t> cdr);

/// The message as YAML, one line a scalar; sequences show their first `items_max` elements. Bytes
/// that are not well-formed end with a line that says so.
std::string to_yaml(const MessageLayout& layout, std::span<const std::uint8_t> cdr,
                    std::size_t items_max);

}  // namespace usher::runtime
