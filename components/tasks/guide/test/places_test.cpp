#include "tasks/guide/core/places.hpp"

#include <gtest/gtest.h>

#include "foundation/random/random.hpp"
#include "tasks/guide/core/visit.hpp"

namespace usher::guide {
namespace {

const std::vector<Location> kPlaces{
    {"meeting_room", "Meeting room", {1, 1}}, {"kitchen", "Kitchen", {5, 5}, {{"de", "Küche"}}},
    {"robotics_lab", "Robotics lab", {9, 0}}, {"vision_lab", "Vision lab", {20, 0}},
    {"cafe", "Café Français", {30, 0}},       {"office_201", "", {40, 0}}};

std::string names(std::string_view query) {
  std::string out;
  for (const auto* hit : search(kPlaces, query, "de", 10))
    out += (out.empty() ? "" : " ") + hit->name;
  return out;
}

TEST(Search, FindsBeginningsThenPartsThenTypingErrors) {
  EXPECT_EQ(names("kit"), "kitchen");
  EXPECT_EQ(names("LAB"), "robotics_lab vision_lab");
  EXPECT_EQ(names("room"), "meeting_room");
  EXPECT_EQ(names("201"), "office_201");
  EXPECT_EQ(names("oom"), "meeting_room");
  EXPECT_EQ(names("kicthen"), "kitchen");
  EXPECT_EQ(names("ktichen"), "kitchen");
  EXPECT_EQ(names("robtics"), "robotics_lab");
  EXPECT_EQ(names("xq"), "");
  EXPECT_EQ(names("zzzz"), "");
  EXPECT_EQ(search(kPlaces, "", "en", 3).size(), 3U);
}

TEST(Search, KnowsTheTitleOfTheLanguageAndElseThePlainOne) {
  EXPECT_EQ(names("kuch"), "kitchen");
  EXPECT_EQ(search(kPlaces, "küche", "fr", 10).size(), 0U);
  EXPECT_EQ(kPlaces[1].label("de"), "Küche");
  EXPECT_EQ(kPlaces[1].label("fr"), "Kitchen");
  EXPECT_EQ(kPlaces[5].label("de"), "office_201");
}

TEST(Search, DoesNotMindAccentsAndCase) {
  EXPECT_EQ(folded("CAFÉ Māori ß Ł ÷"), "cafe maori s l ÷");
  EXPECT_EQ(names("cafe fran"), "cafe");
  EXPECT_EQ(names("CAFÉ"), "cafe");
}

TEST(Search, SurvivesAnyBytes) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string query;
    for (std::uint64_t n = random.below(90); n > 0; --n)
      query += static_cast<char>(random.below(256));
    EXPECT_LE(search(kPlaces, query, "en", 4).size(), 4U);
  }
}

TEST(Nearest, IsTheNearest) {
  EXPECT_EQ(nearest(kPlaces, {6, 4})->name, "kitchen");
  EXPECT_EQ(nearest({}, {0, 0}), nullptr);
  EXPECT_EQ(find(kPlaces, "nowhere"), nullptr);
}

TEST(Memory, SurvivesTheRoundTrip) {
  Memory memory;
  memory.state = "guide_active";
  memory.language = std::string("mi");
  memory.place = "a name with spaces";
  memory.goal_id = 42;
  memory.stopped = true;
  memory.stays = true;
  memory.visit.id = 9;
  memory.visit.place = "kitchen";
  memory.visit.greeted = true;
  memory.visit.touches = 3;
  memory.visit.waits = 2;
  memory.funnel = {5, 4, 3, 2, 1};
  memory.recent = {"kitchen", "lab"};
  const auto read = memory_from_text(to_text(memory));
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(to_text(*read), to_text(memory));
  EXPECT_EQ(read->place, memory.place);
  EXPECT_TRUE(read->stopped && read->stays);
}

TEST(Memory, RefusesWhatItDidNotWrite) {
  EXPECT_NE(memory_from_text("").error().find("line 1"), std::string::npos);
  EXPECT_FALSE(memory_from_text("usher guide 2\n").ok());
  EXPECT_NE(memory_from_text("usher guide 1\ngoal x\n").error().find("line 2: expected a number"),
            std::string::npos);
  EXPECT_FALSE(memory_from_text("usher guide 1\nfoo 1\n").ok());
  EXPECT_FALSE(memory_from_text("usher guide 1\ntouches 99999999999\n").ok());
  const std::string whole = to_text({});
  for (std::size_t i = 0; i < whole.size(); ++i) {  // truncated: refused or read, never worse
    static_cast<void>(memory_from_text(std::string_view(whole).substr(0, i)).ok());
  }
}

}  // namespace
}  // namespace usher::guide
