#include "operations/manifest/site.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/geometry/angle.hpp"
#include "foundation/geometry/footprint.hpp"
#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/map_file.hpp"
#include "operations/manifest/setting.hpp"
#include "operations/manifest/tree.hpp"

namespace usher::operations {

namespace {

/// A component type, and a fact of the site without which it can do nothing.
struct Need {
  std::string_view type, fact;
};
constexpr Need kNeeds[] = {{"map_server", "map"},
                           {"amcl", "initial_pose"},
                           {"guide", "locations"},
                           {"meeting", "locations"},
                           {"meeting", "meeting_rooms"}};

std::string word(const Tree& record, const std::string& field) {
  const Tree* found = record.find(field);
  return found != nullptr ? found->scalar : std::string();
}

std::string point(double x, double y) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f) m", x, y);
  return text;
}

std::string reach_of(const grid::GridGeometry& area) {
  return "from " + point(area.origin_x, area.origin_y) + " to " +
         point(area.origin_x + area.width * area.resolution,
               area.origin_y + area.height * area.resolution);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

class SiteJudge {
 public:
  SiteJudge(const Contracts& contracts, Deployment& deployment, const Tree& site)
      : contracts_(contracts), deployment_(deployment), site_(site) {
    if (const Tree* locations = site.find("locations")) {
      for (const Tree& location : locations->items) {
        const std::string name = word(location, "name");
        if (names_.insert(name).second) listed_ += (listed_.empty() ? "" : ", ") + name;
      }
    }
  }

  void run() {
    judge_needs();
    judge_map();
    judge_rooms();
    judge_titles();
  }

 private:
  void found(Verdict verdict, std::string text, std::string origin) {
    deployment_.findings.push_back({verdict, std::move(text), std::move(origin)});
  }

  /// What the first component that asks for a fact gets; nothing where none asks or nobody gives
  /// it.
  std::optional<Setting> fact(const std::string& name) const {
    for (std::size_t i = 0; i < deployment_.files.size(); ++i) {
      auto given = setting(contracts_, deployment_, i, name);
      if (given && !given->origin.empty()) return given;
    }
    return std::nullopt;
  }

  void judge_needs() {
    const auto& components = deployment_.manifest.components;
    for (std::size_t i = 0; i < components.size(); ++i) {
      const auto anywhere = setting(contracts_, deployment_, i, "start_globally");
      if (anywhere && anywhere->value.number != 0.0) continue;
      for (const auto& [type, name] : kNeeds) {
        if (components[i].type != type) continue;
        if (name == "initial_pose" && !deployment_.manifest.fleet.start.yaml.empty()) continue;
        const Tree* given = site_.find(std::string(name));
        if (given != nullptr && !(given->scalar.empty() && given->items.empty())) continue;
        found(Verdict::kMissingValue,
              "'" + components[i].name + "' needs '" + std::string(name) + "' of the site",
              given != nullptr ? given->origin : site_.origin);
      }
    }
  }

  void judge_map() {
    const auto file = fact("site.map");
    std::error_code ignored;
    if (!file || !std::filesystem::is_regular_file(file->value.text, ignored))
      return;  // found before
    const auto map = grid::load_map(file->value.text);
    if (!map) {
      found(Verdict::kUnreadable, "the map: " + map.error(), file->origin);
      return;
    }
    std::vector<Spot> spots;
    if (const auto start = fact("site.initial_pose"); start && start->value.numbers.size() == 3) {
      const auto& pose = start->value.numbers;
      spots.push_back({"the start", {pose[0], pose[1], pose[2]}, start->origin});
    }
    const auto locations = fact("site.locations");
    const Tree* written = site_.find("locations");
    if (locations && written != nullptr) {
      for (std::size_t i = 0; i < locations->value.records.size(); ++i) {
        const auto& place = locations->value.records[i];
        spots.push_back({"'" + place.text("name") + "'",
                         {place.number("x"), place.number("y"), place.number("yaw")},
                         written->items.at(i).origin});
      }
    }
    const std::size_t before = deployment_.findings.size();
    for (const Spot& spot : spots) judge_pose(spot, *map);
    // Whoever stands in a wall has no way to anywhere.
    if (deployment_.findings.size() == before) judge_ways(spots, *map);
    area_ = map->geometry();
  }

  /// Where the robot shall stand, and where that is said.
  struct Spot {
    std::string what;
    geometry::Pose2 pose;
    std::string origin;

    std::string text() const { return what + " at " + point(pose.x, pose.y); }
  };

  /// From the first one a way leads to each, wide enough for the robot; ground that the map does
  /// not know may be one.
  void judge_ways(const std::vector<Spot>& spots, const grid::OccupancyGrid& map) {
    if (spots.size() < 2) return;
    const grid::GridGeometry& area = map.geometry();
    grid::DistanceField field;
    field.build(map, std::max(needed(map), area.resolution));
    // One cell more: a spot may have room where the middle of its cell has not.
    const double needs = std::clamp(needed(map) - area.resolution, 0.0, field.radius());
    grid::Grid<std::uint8_t> reached(area, 0);
    std::vector<grid::Cell> open;
    const auto enter = [&](const grid::Cell& cell) {
      if (!area.contains(cell) || reached.at(cell) != 0) return;
      if (map.at(cell) == grid::kOccupied || field.distance(cell) < needs) return;
      reached.at(cell) = 1;
      open.push_back(cell);
    };
    enter(area.cell_at(spots.front().pose.x, spots.front().pose.y));
    while (!open.empty()) {
      const grid::Cell cell = open.back();
      open.pop_back();
      for (const grid::Cell next : {grid::Cell{cell.x + 1, cell.y},
                                    {cell.x - 1, cell.y},
                                    {cell.x, cell.y + 1},
                                    {cell.x, cell.y - 1}})
        enter(next);
    }
    for (const Spot& spot : spots) {
      if (reached.at(area.cell_at(spot.pose.x, spot.pose.y)) != 0) continue;
      found(Verdict::kWrongValue,
            spot.text() + " cannot be reached from " + spots.front().text() +
                ": no way of the map is wide enough for the robot (" +
                number(2.0 * inscribed_radius()) + " m)",
            spot.origin);
    }
  }

  /// [m] between the robot's middle and a wall's cells; the map is as coarse as they are.
  double needed(const grid::OccupancyGrid& map) const {
    return std::max(0.0, inscribed_radius() - map.geometry().resolution);
  }

  /// On the map, away from its walls, turned by radians.
  void judge_pose(const Spot& spot, const grid::OccupancyGrid& map) {
    const geometry::Pose2& pose = spot.pose;
    const std::string& origin = spot.origin;
    const std::string there = spot.text();
    if (std::abs(pose.yaw) > 2.0 * geometry::kPi)
      found(Verdict::kWrongValue,
            there + " is turned by " + number(pose.yaw) + " rad, more than a full turn: degrees?",
            origin);
    const grid::GridGeometry& area = map.geometry();
    if (!area.contains(area.cell_at(pose.x, pose.y))) {
      found(Verdict::kWrongValue, there + " is outside the map, which reaches " + reach_of(area),
            origin);
      return;
    }
    const grid::Cell middle = area.cell_at(pose.x, pose.y);
    if (map.at(middle) == grid::kUnknown) {
      found(Verdict::kWrongValue, there + " is where the map knows nothing", origin);
      return;
    }
    const double needs = needed(map);
    double nearest = std::numeric_limits<double>::infinity();
    constexpr double kMostCells = 500.0;
    const int reach = static_cast<int>(std::min(kMostCells, std::ceil(needs / area.resolution)));
    for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
      for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
        const grid::Cell cell{x, y};
        if (!area.contains(cell) || map.at(cell) != grid::kOccupied) continue;
        const double away = (area.center(cell) - pose.position()).norm();
        nearest = std::min(nearest, cell == middle ? 0.0 : away);
      }
    }
    if (nearest == 0.0) {
      found(Verdict::kWrongValue, there + " is in a wall of the map", origin);
    } else if (nearest < needs) {
      found(Verdict::kWrongValue,
            there + " is " + number(nearest) + " m from a wall of the map, nearer than the robot " +
                "can stand to one (" + number(inscribed_radius()) + " m)",
            origin);
    }
  }

  /// [m] of the robot's outline; zero where nobody asks for it, or it is none.
  double inscribed_radius() const {
    const auto corners = fact("robot.footprint");
    if (!corners || corners->value.numbers.size() % 2 != 0) return 0.0;
    std::vector<geometry::Point2> points;
    for (std::size_t i = 0; i < corners->value.numbers.size(); i += 2)
      points.emplace_back(corners->value.numbers[i], corners->value.numbers[i + 1]);
    const auto outline = geometry::Footprint::make(points);
    return outline ? outline->inscribed_radius() : 0.0;
  }

  void judge_rooms() {
    const auto rooms = fact("site.meeting_rooms");
    const Tree* written = site_.find("meeting_rooms");
    if (!rooms || written == nullptr) return;
    for (std::size_t i = 0; i < rooms->value.records.size(); ++i) {
      const auto& room = rooms->value.records[i];
      const std::string who = "the meeting room '" + room.text("name") + "' ";
      const std::string& origin = written->items.at(i).origin;
      if (!(room.number("west") < room.number("east") &&
            room.number("south") < room.number("north")))
        found(Verdict::kWrongValue, who + "must have west < east and south < north", origin);
      judge_place(rooms->value.records, i, who, origin);
      if (!names_.contains(room.text("name")))
        found(Verdict::kWrongValue,
              who + "must have a location of its name, where the robot turns round; there are " +
                  listed_,
              origin);
    }
  }

  /// On the map, given once, over none of the rooms before it.
  void judge_place(const std::vector<runtime::Record>& rooms, std::size_t which,
                   const std::string& who, const std::string& origin) {
    const auto borders = [](const runtime::Record& room) {
      return std::array{room.number("west"), room.number("south"), room.number("east"),
                        room.number("north")};
    };
    const auto [west, south, east, north] = borders(rooms[which]);
    if (area_ && !area_->contains(area_->cell_at(0.5 * (west + east), 0.5 * (south + north))))
      found(Verdict::kWrongValue, who + "is not on the map, which reaches " + reach_of(*area_),
            origin);
    for (std::size_t k = 0; k < which; ++k) {
      const std::string name = rooms[k].text("name");
      const auto [other_west, other_south, other_east, other_north] = borders(rooms[k]);
      if (name == rooms[which].text("name")) {
        found(Verdict::kWrongValue, who + "is given twice", origin);
      } else if (west < other_east && other_west < east && south < other_north &&
                 other_south < north) {
        found(Verdict::kWrongValue, who + "overlaps '" + name + "': nobody knows which one it is",
              origin);
      }
    }
  }

  void judge_titles() {
    const Tree* titles = site_.find("titles");
    if (titles == nullptr) return;
    std::set<std::pair<std::string, std::string>> given;
    for (const Tree& title : titles->items) {
      const std::string place = word(title, "place"), language = word(title, "language");
      if (!names_.contains(place)) {
        found(
            Verdict::kWrongValue,
            "'titles' must be of places among the locations (" + listed_ + "), got '" + place + "'",
            title.origin);
      } else if (!given.emplace(place, language).second) {
        found(Verdict::kWrongValue,
              "'titles' gives '" + place + "' two titles in '" + language + "'", title.origin);
      }
    }
  }

  const Contracts& contracts_;
  Deployment& deployment_;
  const Tree& site_;
  std::set<std::string> names_;             ///< of the locations
  std::string listed_;                      ///< the same as a text
  std::optional<grid::GridGeometry> area_;  ///< of the map that could be read
};

}  // namespace

void judge_site(const Contracts& contracts, Deployment& deployment) {
  if (deployment.manifest.site_file.empty()) return;
  const auto site = read_tree(deployment.manifest.site_file);
  if (!site || (site->kind != Tree::Kind::kMap && site->kind != Tree::Kind::kNull))
    return;  // found before
  SiteJudge(contracts, deployment, *site).run();
}

}  // namespace usher::operations
