#include "navigation/navigator/core/locations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace usher::navigator {
namespace {

Locations site() {
  return *Locations::create({{"foyer", "Foyer", {1, 2, 0}},
                             {"meeting_room_1", "Meeting room 1", {3, 4, 1}},
                             {"meeting_room_2", "Meeting room 2", {5, 6, 2}},
                             {"kitchen", "Kitchen", {7, 8, 3}},
                             {"lab", "Lab", {9, 9, 0}},
                             {"lift", "Lift", {9, 1, 0}}});
}

TEST(Locations, AreFoundByTheirExactName) {
  const auto found = site().find("meeting_room_2");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->title, "Meeting room 2");
  EXPECT_EQ(found->pose, (geometry::Pose2{5, 6, 2}));
}

TEST(Locations, NameTheCloseOnesWhenUnknown) {
  const struct {
    const char* wanted;
    const char* message;
  } table[] = {
      {"kichen", "unknown location \"kichen\", did you mean kitchen?"},
      {"Kitchen", "unknown location \"Kitchen\", did you mean kitchen?"},
      {"meeting room 1",
       "unknown location \"meeting room 1\", did you mean meeting_room_1, meeting_room_2?"},
      {"meeting", "unknown location \"meeting\", did you mean meeting_room_1, meeting_room_2?"},
      {"roof",
       "unknown location \"roof\", known are foyer, meeting_room_1, meeting_room_2, "
       "kitchen, lab, ..."},
      {"",
       "unknown location \"\", known are foyer, meeting_room_1, meeting_room_2, kitchen, lab, "
       "..."},
  };
  for (const auto& row : table) EXPECT_EQ(site().find(row.wanted).error(), row.message);
  EXPECT_EQ(Locations().find("lab").error(), "unknown location \"lab\", no locations are known");
}

TEST(Locations, BoundTheErrorOfAnAbsurdName) {
  EXPECT_LT(site().find(std::string(1'000'000, 'x')).error().size(), 300u);
}

TEST(Locations, RefuseWhatCannotBeMeant) {
  EXPECT_EQ(Locations::create({{"a", "A", {}}, {"a", "B", {}}}).error(),
            "location a is there twice");
  EXPECT_EQ(Locations::create({{"", "A", {}}}).error(), "location 1 has no name");
  EXPECT_EQ(Locations::create({{"a", "A", {0, std::nan(""), 0}}}).error(),
            "location a must have a finite pose");
  std::vector<Location> many(1001);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].name = std::to_string(i);
  EXPECT_EQ(Locations::create(many).error(), "at most 1000 locations, got 1001");
}

}  // namespace
}  // namespace usher::navigator
