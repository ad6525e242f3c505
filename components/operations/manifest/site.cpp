#include "operations/manifest/site.hpp"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
      auto given = setting(contracts_, deployment_, i, "site." + name);
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
    const auto file = fact("map");
    std::error_code ignored;
    if (!file || !std::filesystem::is_regular_file(file->value.text, ignored))
      return;  // found before
    const auto map = grid::load_map(file->value.text);
    if (!map) {
      found(Verdict::kUnreadable, "the map: " + map.error(), file->origin);
      return;
    }
    const auto judge = [&](const std::string& what, double x, double y, const std::string& origin) {
      const grid::GridGeometry& area = map->geometry();
      if (area.contains(area.cell_at(x, y))) return;
      found(Verdict::kWrongValue,
            what + " at " + point(x, y) + " is outside the map, which reaches from " +
                point(area.origin_x, area.origin_y) + " to " +
                point(area.origin_x + area.width * area.resolution,
                      area.origin_y + area.height * area.resolution),
            origin);
    };
    if (const auto start = fact("initial_pose"); start && start->value.numbers.size() == 3)
      judge("the start", start->value.numbers[0], start->value.numbers[1], start->origin);
    const auto locations = fact("locations");
    const Tree* written = site_.find("locations");
    if (!locations || written == nullptr) return;
    for (std::size_t i = 0; i < locations->value.records.size(); ++i) {
      const auto& place = locations->value.records[i];
      judge("'" + place.text("name") + "'", place.number("x"), place.number("y"),
            written->items.at(i).origin);
    }
  }

  void judge_rooms() {
    const auto rooms = fact("meeting_rooms");
    const Tree* written = site_.find("meeting_rooms");
    if (!rooms || written == nullptr) return;
    for (std::size_t i = 0; i < rooms->value.records.size(); ++i) {
      const auto& room = rooms->value.records[i];
      const std::string who = "the meeting room '" + room.text("name") + "' ";
      const std::string& origin = written->items.at(i).origin;
      if (!(room.number("west") < room.number("east") &&
            room.number("south") < room.number("north")))
        found(Verdict::kWrongValue, who + "must have west < east and south < north", origin);
      if (!names_.contains(room.text("name")))
        found(Verdict::kWrongValue,
              who + "must have a location of its name, where the robot turns round; there are " +
                  listed_,
              origin);
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
  std::set<std::string> names_;  ///< of the locations
  std::string listed_;           ///< the same as a text
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
