#include <gmock/gmock.h>

#include "idl/topics.hpp"
#include "runtime/dds/idl_text.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"
#include "vectors.hpp"

namespace usher::runtime {
namespace {

using test::bytes;
using testing::HasSubstr;

TEST(MessageLayouts, ReadTheIdlThatTheTypesWereGeneratedFrom) {
  const auto parsed = MessageLayouts::parse(idl_text());
  ASSERT_TRUE(parsed.ok()) << parsed.error();
  const MessageLayout* scan = parsed->find("sensor_msgs::msg::LaserScan");
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan, parsed->find("sensor_msgs::msg::dds_::LaserScan_"));
  ASSERT_EQ(scan->fields.size(), 10U);
  EXPECT_EQ(scan->fields[8].name, "ranges");
  EXPECT_TRUE(scan->fields[8].sequence);
  EXPECT_EQ(parsed->find("sensor_msgs::msg::Nothing"), nullptr);
  EXPECT_EQ(parsed->find(""), nullptr);
}

TEST(MessageLayouts, AgreeWithTheGeneratedCodeForEveryTopic) {
  // Fast CDR wrote it, the layout passes over it to the last byte: also one byte less is noticed.
  std::apply(
      [](const auto&... topic) {
        (
            [&] {
              const typename std::remove_cvref_t<decltype(topic)>::Message message;
              const MessageType& type = *message_type_by_topic(topic.name);
              const MessageLayout* layout = MessageLayouts::built_in().find(type.name);
              ASSERT_NE(layout, nullptr) << topic.name;
              Bytes cdr;
              ASSERT_TRUE(type.serialize(&message, cdr));
              EXPECT_TRUE(is_well_formed(*layout, cdr)) << topic.name;
              EXPECT_FALSE(is_well_formed(*layout, std::span(cdr).first(cdr.size() - 1)))
                  << topic.name;
              cdr.resize(cdr.size() + 4);
              EXPECT_FALSE(is_well_formed(*layout, cdr)) << topic.name;
            }(),
            ...);
      },
      topics::kAll);
}

TEST(MessageLayouts, RefuseIdlThatTheyDoNotUnderstand) {
  const auto error = [](std::string_view idl) {
    const auto parsed = MessageLayouts::parse(idl);
    return parsed.ok() ? std::string("no error") : parsed.error();
  };
  EXPECT_THAT(error("struct A {\n  wstring x;\n};"), HasSubstr("unknown type 'wstring'"));
  EXPECT_THAT(error("struct A {\n  wstring x;\n};"), HasSubstr("line 2"));
  EXPECT_THAT(error("union U switch(long) {};"), HasSubstr("expected module, struct or const"));
  EXPECT_THAT(error("struct A { int32 x"), HasSubstr("expected ';'"));
  EXPECT_THAT(error("struct A { int32 x[N]; };"), HasSubstr("literal size"));
  EXPECT_THAT(error("struct A { };"), HasSubstr("no members"));
  EXPECT_THAT(error("struct A { int8 x; }; struct A { int8 x; };"), HasSubstr("defined twice"));
  EXPECT_THAT(error("struct A { A x; };"), HasSubstr("unknown type 'A'"));
  EXPECT_THAT(error("module m { struct A { int8 x; };"), HasSubstr("expected '}'"));
  EXPECT_EQ(
      error(
          "module m { const octet K = 1; /* c */ struct A { @default(1) int8 x[3]; }; };  // end"),
      "no error");
}

std::string yaml_of(const char* type, const Bytes& cdr, std::size_t items = 8) {
  return to_yaml(*MessageLayouts::built_in().find(type), cdr, items);
}

TEST(MessageText, ShowsAScan) {
  EXPECT_EQ(yaml_of("sensor_msgs::msg::LaserScan", bytes(test::kLaserScanVector), 2),
            "header:\n"
            "  stamp:\n"
            "    sec: 1700000000\n"
            "    nanosec: 250000000\n"
            "  frame_id: \"laser\"\n"
            "angle_min: -1.5\n"
            "angle_max: 1.5\n"
            "angle_increment: 1.5\n"
            "time_increment: 0\n"
            "scan_time: 0.02\n"
            "range_min: 0.5\n"
            "range_max: 20\n"
            "ranges: [1, 2]  # first of 3\n"
            "intensities: []\n");
}

TEST(MessageText, ShowsNestedSequences) {
  EXPECT_EQ(yaml_of("diagnostic_msgs::msg::DiagnosticArray", bytes(test::kDiagnosticsVector)),
            "header:\n"
            "  stamp:\n"
            "    sec: 1700000000\n"
            "    nanosec: 250000000\n"
            "  frame_id: \"\"\n"
            "status:\n"
            "- level: 1\n"
            "  name: \"a\"\n"
            "  message: \"b\"\n"
            "  hardware_id: \"c\"\n"
            "  values:\n"
            "  - key: \"k\"\n"
            "    value: \"v\"\n");
}

TEST(MessageText, SaysWhenTheBytesAreNotSuchAMessage) {
  const std::string text =
      yaml_of("std_msgs::msg::Header", bytes("00 01 00 00 01 00 00 00 02 00 00 00 ff ff 00 00 61"));
  EXPECT_THAT(text, HasSubstr("sec: 1\n"));
  EXPECT_THAT(text, HasSubstr("# not a message of type std_msgs::msg::Header (17 bytes)\n"));
}

TEST(MessageText, EscapesWhatTerminalsObey) {
  const std::string text =
      yaml_of("std_msgs::msg::String", bytes("00 01 00 00 05 00 00 00 1b 22 5c 0a 00"));
  EXPECT_EQ(text, "data: \"\\x1b\\\"\\\\\\x0a\"\n");
}

}  // namespace
}  // namespace usher::runtime
