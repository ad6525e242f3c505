#include "operations/manifest/site.hpp"

#include <gmock/gmock.h>

#include "support/folder.hpp"

namespace usher::operations {
namespace {

using runtime::Contract;
using runtime::ParameterKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Contract::Parameter fact(const std::string& name, ParameterKind kind,
                         const std::vector<std::string>& numbers = {}) {
  Contract::Parameter parameter;
  parameter.name = name;
  parameter.unit = "-";
  parameter.kind = kind;
  parameter.range = {-1e4, 1e4};
  parameter.count_min = parameter.count_max = 3;
  if (kind == ParameterKind::kRecords)
    parameter.fields.push_back({"name", ParameterKind::kText, "-", {}, "Name."});
  for (const auto& field : numbers)
    parameter.fields.push_back({field, ParameterKind::kNumber, "m", {-1e4, 1e4}, "Where."});
  return parameter;
}

/// A site with a map of 4 x 2 m from (-1, 0) on, and whoever needs something of it.
class Site : public testing::Test {
 protected:
  Site() {
    auto start = fact("site.initial_pose", ParameterKind::kNumbers);
    start.fallback = "[0, 0, 0]";
    auto anywhere = fact("start_globally", ParameterKind::kFlag);
    anywhere.fallback = "false";
    const auto locations = fact("site.locations", ParameterKind::kRecords, {"x", "y", "yaw"});
    const auto rooms =
        fact("site.meeting_rooms", ParameterKind::kRecords, {"west", "south", "east", "north"});
    add("map_server", {fact("site.map", ParameterKind::kFile)});
    add("amcl", {start, anywhere});
    add("guide", {locations});
    add("meeting", {locations, rooms});
    folder_.file("config/robots/r.yaml", "");
    map("map.pgm");
    folder_.file("config/sites/s/map.pgm", "P2\n4 2\n255\n255 255 255 255\n255 255 255 255\n");
  }
  void add(const std::string& type, std::vector<Contract::Parameter> parameters) {
    contracts_[type].component = type;
    contracts_[type].parameters = std::move(parameters);
  }
  void map(const std::string& image) {
    folder_.file("config/sites/s/map.yaml", "image: " + image +
                                                "\nresolution: 1.0\norigin: [-1.0, 0.0, 0.0]\n"
                                                "negate: 0\noccupied_thresh: 0.65\n"
                                                "free_thresh: 0.196\n");
  }
  /// What is found in a site's file, without the folder.
  std::vector<std::string> findings(const std::string& site, const std::string& components,
                                    const std::string& more = {}) {
    folder_.file("config/sites/s/site.yaml", site);
    const auto path = folder_.file("deploy/m.yaml", "robot: r\nsite: s\nhosts: {nuc: {}}\n" + more +
                                                        "components: {" + components + "}\n");
    const auto manifest = read_manifest(path, {folder_.path() + "/config"});
    EXPECT_TRUE(manifest) << (manifest ? "" : manifest.error());
    std::vector<std::string> found;
    for (const auto& finding : resolve(*manifest, contracts_, {}).findings) {
      if (finding.verdict == Verdict::kWrongIdl) continue;
      std::string text = to_string(finding);
      for (auto at = text.find(folder_.path()); at != std::string::npos;
           at = text.find(folder_.path()))
        text.erase(at, folder_.path().size() + 1);
      found.push_back(std::move(text));
    }
    return found;
  }

  test::Folder folder_;
  Contracts contracts_;
};

constexpr const char* kGuide = "map_server: {host: nuc}, amcl: {host: nuc}, guide: {host: nuc}";
constexpr const char* kMeeting = "map_server: {host: nuc}, meeting: {host: nuc}";
constexpr const char* kFacts = "map: map.yaml\ninitial_pose: [0, 1, 0]\n";

TEST_F(Site, IsGoodWithWhatItsComponentsNeed) {
  EXPECT_THAT(
      findings(std::string(kFacts) + "locations:\n  - {name: kitchen, x: 2.9, y: 1.9, yaw: 0}\n",
               kGuide),
      IsEmpty());
}

TEST_F(Site, MissesWhatAComponentNeeds) {
  EXPECT_THAT(findings("locations:\n  - {name: kitchen, x: 1, y: 1, yaw: 0}\n", kGuide),
              ElementsAre("config/sites/s/site.yaml:1: missing value: 'map_server' needs 'map' of "
                          "the site",
                          "config/sites/s/site.yaml:1: missing value: 'amcl' needs 'initial_pose' "
                          "of the site"));
  EXPECT_THAT(findings(std::string(kFacts) + "locations: []\n", kGuide),
              ElementsAre("config/sites/s/site.yaml:3: missing value: 'guide' needs 'locations' of "
                          "the site"));
  EXPECT_THAT(findings("map: map.yaml\n", kMeeting),
              ElementsAre(HasSubstr("'meeting' needs 'locations'"),
                          HasSubstr("'meeting' needs 'meeting_rooms'")));
}

TEST_F(Site, NeedsNoStartWhereItIsSaidElsewhere) {
  EXPECT_THAT(findings("map: map.yaml\n",
                       "map_server: {host: nuc}, amcl: {host: nuc, parameters: {start_globally: "
                       "true}}"),
              IsEmpty());
  const std::string fleet = "fleet: {domain: 60, robot: iris, start: ";
  const std::string own = "map_server: {host: nuc}, amcl: {host: nuc}";
  EXPECT_THAT(findings("map: map.yaml\n", own, fleet + "[1, 1, 0]}\n"), IsEmpty());
  EXPECT_THAT(findings("map: map.yaml\n", own, fleet + "[9, 1, 0]}\n"),
              ElementsAre(HasSubstr("deploy/m.yaml:4: wrong value: the start at (9.00, 1.00) m is "
                                    "outside the map")));
}

TEST_F(Site, HasAMapThatCanBeRead) {
  map("none.pgm");
  EXPECT_THAT(findings("map: map.yaml\n", "map_server: {host: nuc}"),
              ElementsAre("config/sites/s/site.yaml:1: unreadable: the map: "
                          "config/sites/s/none.pgm: expected a file, found none"));
}

TEST_F(Site, LiesOnItsMap) {
  EXPECT_THAT(
      findings(
          "map: map.yaml\ninitial_pose: [-1.5, 1, 0]\nlocations:\n"
          "  - {name: kitchen, x: -0.9, y: 0.1, yaw: 0}\n  - {name: lab, x: 1, y: 2.1, yaw: 0}\n",
          kGuide),
      ElementsAre(
          "config/sites/s/site.yaml:2: wrong value: the start at (-1.50, 1.00) m is outside "
          "the map, which reaches from (-1.00, 0.00) m to (3.00, 2.00) m",
          "config/sites/s/site.yaml:5: wrong value: 'lab' at (1.00, 2.10) m is outside the "
          "map, which reaches from (-1.00, 0.00) m to (3.00, 2.00) m"));
}

TEST_F(Site, HasRoomForTheRobotWhereItShallStand) {
  auto outline = fact("robot.footprint", ParameterKind::kNumbers);
  folder_.file("config/robots/r.yaml", "footprint: [1.2, 1.2, -1.2, 1.2, -1.2, -1.2, 1.2, -1.2]\n");
  outline.count_min = outline.count_max = 8;
  add("amcl", {fact("site.initial_pose", ParameterKind::kNumbers), outline});
  folder_.file("config/sites/s/map.pgm", "P2\n4 2\n255\n0 255 255 205\n255 255 255 255\n");
  EXPECT_THAT(
      findings("map: map.yaml\ninitial_pose: [-0.5, 1.5, 90]\nlocations:\n"
               "  - {name: free, x: 0.5, y: 0.5, yaw: 0}\n"
               "  - {name: unknown, x: 2.5, y: 1.5, yaw: 0}\n",
               kGuide),
      ElementsAre(HasSubstr("site.yaml:2: wrong value: the start at (-0.50, 1.50) m is turned by "
                            "90.00 rad, more than a full turn: degrees?"),
                  HasSubstr("site.yaml:2: wrong value: the start at (-0.50, 1.50) m is in a wall"),
                  HasSubstr("'unknown' at (2.50, 1.50) m is where the map knows nothing")));
}

TEST_F(Site, HasWaysToItsPlacesThatAreWideEnough) {
  const auto reached = [&](double half_side) {
    const std::string s = std::to_string(half_side), n = ", -" + s;
    auto outline = fact("robot.footprint", ParameterKind::kNumbers);
    outline.count_min = outline.count_max = 8;
    add("amcl", {fact("site.initial_pose", ParameterKind::kNumbers), outline});
    folder_.file("config/robots/r.yaml",
                 "footprint: [" + s + ", " + s + n + ", " + s + n + n + ", " + s + n + "]\n");
    return findings(
        "map: map.yaml\ninitial_pose: [-0.5, 1.5, 0]\nlocations:\n"
        "  - {name: here, x: 0.5, y: 1.5, yaw: 0}\n"
        "  - {name: lab, x: 7.5, y: 1.5, yaw: 0}\n",
        kGuide);
  };
  const std::string room = "255 255 255 255 ", wall = room + "0 " + room + "\n";
  const std::string door = room + "205 " + room + "\n";
  folder_.file("config/sites/s/map.pgm", "P2\n9 3\n255\n" + wall + door + wall);
  EXPECT_THAT(reached(2.9), IsEmpty()) << "through the door, which the map does not know";
  EXPECT_THAT(reached(3.1),
              ElementsAre("config/sites/s/site.yaml:5: wrong value: 'lab' at (7.50, 1.50) m cannot "
                          "be reached from the start at (-0.50, 1.50) m: no way of the map is wide "
                          "enough for the robot (6.20 m)"));
  folder_.file("config/sites/s/map.pgm", "P2\n9 3\n255\n" + wall + wall + wall);
  EXPECT_THAT(reached(0.3), ElementsAre(HasSubstr("'lab' at (7.50, 1.50) m cannot be reached")));
}

TEST_F(Site, HasRoomsOnItsMapEachOnceAndApart) {
  const std::string site =
      "map: map.yaml\nlocations:\n  - {name: blue, x: 1, y: 1, yaw: 0}\n"
      "  - {name: red, x: 1, y: 1, yaw: 0}\nmeeting_rooms:\n"
      "  - {name: blue, west: 0, south: 0, east: 1, north: 1}\n";
  EXPECT_THAT(findings(site + "  - {name: red, west: 1, south: 0, east: 2, north: 1}\n", kMeeting),
              IsEmpty())
      << "side by side";
  EXPECT_THAT(
      findings(site + "  - {name: red, west: 0.5, south: 0.5, east: 2, north: 1.5}\n"
                      "  - {name: blue, west: 2.5, south: 0, east: 5, north: 1}\n",
               kMeeting),
      ElementsAre(
          "config/sites/s/site.yaml:7: wrong value: the meeting room 'red' overlaps 'blue': "
          "nobody knows which one it is",
          "config/sites/s/site.yaml:8: wrong value: the meeting room 'blue' is not on the "
          "map, which reaches from (-1.00, 0.00) m to (3.00, 2.00) m",
          "config/sites/s/site.yaml:8: wrong value: the meeting room 'blue' is given twice"));
}

TEST_F(Site, HasRoomsWithAnInsideAndALocation) {
  const std::string site =
      "map: map.yaml\nlocations:\n  - {name: blue, x: 1, y: 1, yaw: 0}\n"
      "  - {name: red, x: 1, y: 1, yaw: 0}\n";
  EXPECT_THAT(
      findings(site + "meeting_rooms:\n"
                      "  - {name: blue, west: 0, south: 0, east: 1, north: 1}\n"
                      "  - {name: bleu, west: 1, south: 0, east: 2, north: 1}\n"
                      "  - {name: red, west: 2, south: 0, east: 1, north: 1}\n",
               kMeeting),
      ElementsAre("config/sites/s/site.yaml:7: wrong value: the meeting room 'bleu' must have a "
                  "location of its name, where the robot turns round; there are blue, red",
                  "config/sites/s/site.yaml:8: wrong value: the meeting room 'red' must have west "
                  "< east and south < north"));
}

}  // namespace
}  // namespace usher::operations
