#pragma once

#include <string>
#include <vector>

namespace usher::contract {

/// The parts of our IDL files that the lint looks at. Not a parser of IDL: it reads what we write.
struct IdlField {
  std::string type;  ///< "sequence<float>", "double[36]", "std_msgs::msg::Header"
  std::string name;
  std::string comment;  ///< after ///<, empty when there is none
  int line = 0;
};
struct IdlStruct {
  std::string package, name;
  std::vector<IdlField> fields;
};
struct IdlConstant {
  std::string module, name;
  std::string value;
  int line = 0;
};
struct IdlFile {
  std::vector<IdlStruct> structs;
  std::vector<IdlConstant> constants;
};

IdlFile read_idl(const std::string& text);

/// "sequence<geometry_msgs::msg::Pose>" -> "geometry_msgs/Pose[]", "octet" -> "uint8".
std::string ros_type(const std::string& idl_type);

/// What is wrong with a field's comment; empty when it has the form [unit] (frame) {range}
/// Sentence.
std::string comment_breach(const std::string& comment);

}  // namespace usher::contract
