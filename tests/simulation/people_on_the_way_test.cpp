// People along the way of MARVIN who do not stand upright and alone: one sits on a chair, one bends
// down, three stand together and talk.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/site_facts.hpp"
#include "simulation/watched_people.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

constexpr const char* kHall = R"(name: hall
ceiling: 2.7
rooms:
  - {name: hall, title: Hall, area: [0.0, 0.0, 12.0, 6.0]}
walls:
  - {name: around, thickness: 0.2, points: [[-0.1, -0.1], [12.1, -0.1], [12.1, 6.1], [-0.1, 6.1], [-0.1, -0.1]]}
obstacles:
  - {name: chair, chair: [4.4, 4.3, -1.9]}
)";
constexpr const char* kPeople = R"(people:
  - {name: sits, at: [4.4, 4.3], yaw: -1.9, height: 1.7, posture: sitting}
  - {name: bends, at: [6.3, 1.7], yaw: 2.6, height: 1.8, posture: bending}
  - {name: talks_1, at: [9.4, 5.0], yaw: -1.57, height: 1.6}
  - {name: talks_2, at: [8.85, 4.1], yaw: 0.5, height: 1.75}
  - {name: talks_3, at: [9.95, 4.1], yaw: 2.6, height: 1.9}
)";

TEST(PeopleOnTheWay, AreFoundInWhateverPostureAndNotTouched) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const test::Folder folder;
  const std::string manifest = folder.file(
      "hall.yaml", "extends: " + share + "/deploy/marvin-depth-sim.yaml\nsite: obstacle_course\n");
  auto deployment = load_deployment(manifest, installation, {{"world", "people", "true"}});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  set_site_value(*deployment, "site.world", folder.file("world.yaml", kHall));
  set_value(*deployment, "world", "site.people", folder.file("people.yaml", kPeople));
  std::map<std::string, int> by_kinect, by_rear;
  int nobody = 0;
  std::unique_ptr<WatchedPeople> people;
  const auto robot = lockstep_robot(*deployment, 1, [&](LockstepRun& run) {
    people = std::make_unique<WatchedPeople>(run, [&](const auto& person, const auto* who) {
      if (who == nullptr) {
        ++nobody;
      } else if (person.by_kinect()) {
        ++by_kinect[who->name()];
      } else if (person.by_rear()) {
        ++by_rear[who->name()];
      }
    });
  });
  ASSERT_TRUE(robot.ok()) << robot.error();

  const auto arrival = (*robot)->send("goal", 90.0);
  ASSERT_TRUE(arrival.ok()) << arrival.error();
  EXPECT_TRUE(arrival->reported) << arrival->reason;
  const auto summary = (*robot)->take_record().summary();
  std::printf("%.1f s, %.2f m, clearance %.2f m, %d nobody\n", summary.seconds, summary.path,
              summary.smallest_clearance, nobody);
  EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
  for (const char* name : {"sits", "bends", "talks_1", "talks_2", "talks_3"}) {
    std::printf("%s: %d by the Kinect, %d by the rear camera\n", name, by_kinect[name],
                by_rear[name]);
    EXPECT_GE(by_kinect[name], 20) << name;
  }
  EXPECT_LE(nobody, 10);
}

}  // namespace
}  // namespace usher::operations
