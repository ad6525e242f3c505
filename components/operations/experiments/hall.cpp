#include "operations/experiments/hall.hpp"

#include <cctype>
#include <cstdio>
#include <filesystem>

#include "foundation/grid/map_file.hpp"
#include "operations/results/result_sheet.hpp"
#include "simulation/world/core/map_drawing.hpp"
#include "simulation/world/core/world_file.hpp"

namespace usher::operations {

namespace {

std::string location(const std::string& name, const geometry::Pose2& pose) {
  char place[96];
  std::snprintf(place, sizeof place, "x: %.3f, y: %.3f, yaw: %.4f", pose.x, pose.y, pose.yaw);
  std::string title = name;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return "  - {name: " + name + ", title: " + title + ", " + place + "}\n";
}

std::string site_of(const Hall& hall) {
  char pose[96];
  std::snprintf(pose, sizeof pose, "%.3f, %.3f, %.4f", hall.start.x, hall.start.y, hall.start.yaw);
  std::string text = "map: map.yaml\nworld: world.yaml\n";
  if (!hall.people.empty()) text += "people: people.yaml\n";
  text.append("initial_pose: [").append(pose).append("]\nlocations:\n");
  text += location("start", hall.start);
  for (const auto& [name, place] : hall.places) text += location(name, place);
  return text;
}

}  // namespace

Result<Deployment> deploy_in_hall(const Hall& hall, const std::string& manifest,
                                  const std::string& folder, const Installation& installation,
                                  const std::vector<Override>& overrides) {
  const std::string here = std::filesystem::absolute(folder).string();
  Status saved = write_file(here + "/world.yaml", hall.world);
  if (saved && !hall.people.empty()) saved = write_file(here + "/people.yaml", hall.people);
  if (saved) saved = write_file(here + "/site.yaml", site_of(hall));
  if (!saved) return Error{saved.error()};
  const auto building = world::load_building(here + "/world.yaml");
  if (!building) return Error{building.error()};
  const world::Scene scene(world::construct(*building), building->ceiling);
  const world::MapDrawing drawing{.start = hall.start.position()};
  saved = grid::save_map(world::draw_map(scene, drawing), here + "/map.yaml");
  if (!saved) return Error{saved.error()};
  const auto contracts = read_contracts(installation.contracts);
  if (!contracts) return Error{contracts.error()};
  const std::string path = installation.share + "/deploy/" + manifest + ".yaml";
  auto read = read_manifest(path, config_directories(path, installation));
  if (!read) return Error{read.error()};
  read->site_file = here + "/site.yaml";
  return resolve(*read, *contracts, overrides);
}

}  // namespace usher::operations
