#include "simulation/world/core/world_file.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

namespace usher::world {
namespace {

constexpr double kFarthest = 1000.0;         // [m] of any coordinate
constexpr std::size_t kMostEntries = 10000;  // of any list
constexpr std::size_t kLargestFile = 4 << 20;

// Within this file errors are thrown: a parser that fails anywhere fails as a whole. They end in
// parse().
struct ParseError : std::runtime_error {
  ParseError(const YAML::Mark& mark, const std::string& text)
      : std::runtime_error(std::to_string(mark.line + 1) + ": " + text) {}
};

std::string found(const YAML::Node& node) {
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsMap() ? "a map" : node.IsSequence() ? "a list" : "nothing";
}

/// A map of the file with the keys that it may have.
class Entry {
 public:
  Entry(const YAML::Node& node, std::string what, std::initializer_list<const char*> keys)
      : node_(node), what_(std::move(what)) {
    if (!node.IsMap()) throw ParseError(node.Mark(), what_ + " must be a map, got " + found(node));
    std::set<std::string> seen;
    for (const auto& pair : node) {
      const std::string key = pair.first.Scalar();
      bool known = false;
      std::string names;
      for (const char* allowed : keys) {
        known = known || key == allowed;
        names += (names.empty() ? "" : ", ") + std::string(allowed);
      }
      if (!known) {
        throw ParseError(pair.first.Mark(),
                         "unknown key '" + key + "' of " + what_ + "; expected one of " + names);
      }
      if (!seen.insert(key).second) {
        throw ParseError(pair.first.Mark(), "key '" + key + "' of " + what_ + " appears twice");
      }
    }
  }

  bool has(const char* key) const { return node_[key].IsDefined(); }
  YAML::Node at(const char* key) const {
    const YAML::Node value = node_[key];
    if (!value.IsDefined()) {
      throw ParseError(node_.Mark(), what_ + " needs the key '" + std::string(key) + "'");
    }
    return value;
  }
  YAML::Mark mark() const { return node_.Mark(); }

  std::string text(const char* key) const {
    const YAML::Node node = at(key);
    if (!node.IsScalar() || node.Scalar().empty()) {
      throw ParseError(node.Mark(), label(key) + " must be a text, got " + found(node));
    }
    return node.Scalar();
  }
  bool flag(const char* key) const {
    const YAML::Node node = at(key);
    bool value = false;
    if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) {
      throw ParseError(node.Mark(), label(key) + " must be true or false, got " + found(node));
    }
    return value;
  }
  double number(const char* key, double low, double high) const {
    return number(at(key), label(key), low, high);
  }
  std::vector<double> numbers(const char* key, std::size_t count) const {
    return numbers(at(key), label(key), count);
  }
  std::vector<Point2> points(const char* key, std::size_t least) const {
    const YAML::Node node = at(key);
    if (!node.IsSequence() || node.size() < least || node.size() > kMostEntries) {
      throw ParseError(node.Mark(), label(key) + " must be a list of at least " +
                                        std::to_string(least) + " points, got " + found(node));
    }
    std::vector<Point2> points;
    for (const YAML::Node& item : node) {
      const auto xy = numbers(item, "point of " + label(key), 2);
      points.emplace_back(xy[0], xy[1]);
    }
    return points;
  }
  YAML::Node list(const char* key) const {
    const YAML::Node node = at(key);
    if (!node.IsSequence() || node.size() > kMostEntries) {
      throw ParseError(node.Mark(), label(key) + " must be a list, got " + found(node));
    }
    return node;
  }

 private:
  std::string label(const char* key) const { return what_ + "." + key; }

  static double number(const YAML::Node& node, const std::string& label, double low, double high) {
    double value = 0.0;
    std::ostringstream range;
    range << "[" << low << ", " << high << "]";
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) ||
        !(value >= low && value <= high)) {
      throw ParseError(node.Mark(),
                       label + " must be a number in " + range.str() + ", got " + found(node));
    }
    return value;
  }
  static std::vector<double> numbers(const YAML::Node& node, const std::string& label,
                                     std::size_t count) {
    if (!node.IsSequence() || node.size() != count) {
      throw ParseError(node.Mark(), label + " must be a list of " + std::to_string(count) +
                                        " numbers, got " + found(node));
    }
    std::vector<double> values;
    for (const YAML::Node& item : node) {
      values.push_back(number(item, label, -kFarthest, kFarthest));
    }
    return values;
  }

  YAML::Node node_;
  std::string what_;
};

Room parse_room(const YAML::Node& node) {
  const Entry entry(node, "room", {"name", "title", "area"});
  const auto area = entry.numbers("area", 4);
  if (!(area[0] < area[2] && area[1] < area[3])) {
    throw ParseError(entry.mark(), "room.area must be [x_min, y_min, x_max, y_max]");
  }
  return {entry.text("name"), entry.text("title"), {area[0], area[1]}, {area[2], area[3]}};
}

WallLine parse_wall(const YAML::Node& node, Material material) {
  const Entry entry(node, material == Material::kGlass ? "glass" : "wall",
                    {"name", "thickness", "points"});
  WallLine line{entry.text("name"), material, entry.number("thickness", 0.005, 2.0),
                entry.points("points", 2)};
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    if ((line.points[i + 1] - line.points[i]).norm() < 1e-3) {
      throw ParseError(entry.mark(), "wall '" + line.name + "' has two equal points in a row");
    }
  }
  return line;
}

Gap parse_gap(const YAML::Node& node, bool door) {
  const Entry entry = door ? Entry(node, "door", {"name", "at", "width", "open"})
                           : Entry(node, "opening", {"at", "width"});
  const auto at = entry.numbers("at", 2);
  Gap gap;
  gap.door = door;
  gap.at = {at[0], at[1]};
  gap.width = entry.number("width", 0.1, 20.0);
  if (door) gap.name = entry.text("name");
  if (door && entry.has("open")) gap.open = entry.flag("open");
  return gap;
}

/// A table top 40 mm thick on four legs.
std::vector<Thing> table(const std::string& name, const Pose2& pose, double length, double width,
                         double height) {
  constexpr double kThick = 0.04, kLeg = 0.05;  // [m]
  std::vector<Thing> things{box(name, pose, length, width, height - kThick, height)};
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Point2 at = pose * Point2(x * (length - kLeg), y * (width - kLeg));
      things.push_back(box(name + " leg " + std::to_string(things.size()),
                           {at.x(), at.y(), pose.yaw}, kLeg, kLeg, 0.0, height - kThick));
    }
  }
  return things;
}

/// An office chair of about 0.6 m across and 0.9 m high: foot, column, seat, back.
std::vector<Thing> chair(const std::string& name, const Pose2& pose) {
  const Point2 back = pose * Point2(-0.23, 0.0);
  const Point2 middle = pose.position();
  return {disc(name, middle, 0.24, 0.42, 0.50), disc(name + " foot", middle, 0.30, 0.03, 0.10),
          disc(name + " column", middle, 0.04, 0.10, 0.42),
          box(name + " back", {back.x(), back.y(), pose.yaw}, 0.06, 0.42, 0.50, 0.90)};
}

std::vector<Thing> parse_furniture(const YAML::Node& node) {
  const Entry entry(node, "furniture",
                    {"name", "box", "disc", "table", "chair", "height", "glass"});
  int kinds = 0;
  for (const char* kind : {"box", "disc", "table", "chair"}) kinds += entry.has(kind);
  if (kinds != 1) {
    throw ParseError(entry.mark(), "furniture needs one of 'box', 'disc', 'table', 'chair'");
  }
  const std::string name = entry.text("name");
  if (entry.has("chair")) {
    const auto v = entry.numbers("chair", 3);
    return chair(name, {v[0], v[1], v[2]});
  }
  if (entry.has("table")) {
    const auto v = entry.numbers("table", 5);
    if (!(v[3] >= 0.2 && v[4] >= 0.2)) {
      throw ParseError(entry.mark(),
                       "furniture.table must be [x, y, yaw, length, width], sides from 0.2 m");
    }
    return table(name, {v[0], v[1], v[2]}, v[3], v[4], entry.number("height", 0.3, 1.5));
  }
  const auto height = entry.numbers("height", 2);
  const bool pit = height[0] < 0.0 && height[1] == 0.0;
  if (!pit && !(height[0] >= 0.0 && height[0] < height[1])) {
    throw ParseError(entry.mark(),
                     "furniture.height must be [bottom, top], 0 <= bottom < top, or [-depth, 0] "
                     "for a pit");
  }
  Thing thing;
  if (entry.has("box")) {
    const auto v = entry.numbers("box", 5);
    if (!(v[3] > 0.0 && v[4] > 0.0)) {
      throw ParseError(entry.mark(),
                       "furniture.box must be [x, y, yaw, length, width], sides above 0");
    }
    thing = box(name, {v[0], v[1], v[2]}, v[3], v[4], height[0], height[1]);
  } else {
    const auto v = entry.numbers("disc", 3);
    if (!(v[2] > 0.0)) {
      throw ParseError(entry.mark(), "furniture.disc must be [x, y, radius], radius above 0");
    }
    thing = disc(name, {v[0], v[1]}, v[2], height[0], height[1]);
  }
  if (entry.has("glass") && entry.flag("glass")) thing.material = Material::kGlass;
  return {thing};
}

rendering::Posture parse_posture(const Entry& entry) {
  using rendering::Posture;
  static const std::map<std::string, Posture> kPostures{{"standing", Posture::kStanding},
                                                        {"sitting", Posture::kSitting},
                                                        {"squatting", Posture::kSquatting},
                                                        {"bending", Posture::kBending},
                                                        {"arms_out", Posture::kArmsOut}};
  const auto found = kPostures.find(entry.text("posture"));
  if (found == kPostures.end()) {
    throw ParseError(entry.mark(),
                     "person.posture must be standing, sitting, squatting, bending or arms_out");
  }
  return found->second;
}

PersonPlan parse_person(const YAML::Node& node) {
  const Entry entry(
      node, "person",
      {"name", "at", "yaw", "speed", "pause", "loop", "height", "posture", "watches"});
  PersonPlan plan;
  plan.name = entry.text("name");
  if (entry.has("at") == entry.has("loop")) {
    throw ParseError(entry.mark(), "person needs either 'at' (stands) or 'loop' (walks)");
  }
  if (entry.has("loop")) {
    plan.loop = entry.points("loop", 2);
    plan.start = plan.loop.front();
  } else {
    const auto at = entry.numbers("at", 2);
    plan.start = {at[0], at[1]};
  }
  if (entry.has("yaw")) plan.yaw = entry.number("yaw", -10.0, 10.0);
  if (entry.has("speed")) plan.speed = entry.number("speed", 0.1, 2.5);
  if (entry.has("pause")) plan.pause = entry.number("pause", 0.0, 600.0);
  if (entry.has("height")) plan.height = entry.number("height", 1.2, 2.1);
  if (entry.has("posture")) plan.posture = parse_posture(entry);
  if (entry.has("watches")) plan.watches = entry.flag("watches");
  return plan;
}

template <class Item>
void insist_on_new_name(std::set<std::string>& names, const Item& item, const YAML::Node& node) {
  if (!names.insert(item.name).second) {
    throw ParseError(node.Mark(), "the name '" + item.name + "' is used twice");
  }
}

/// Where a point lies on a line [m from its start], or nothing when it lies beside it.
std::optional<double> place_on(const Point2& from, const Point2& to, const Point2& p) {
  constexpr double kBeside = 0.01;
  const Point2 along = (to - from).normalized();
  const double s = (p - from).dot(along);
  const Point2 off = p - from - s * along;
  if (off.norm() > kBeside || s < 0.0 || s > (to - from).norm()) return std::nullopt;
  return s;
}

bool lies_on_a_wall(const Building& building, const Gap& gap) {
  for (const WallLine& line : building.walls) {
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      const auto s = place_on(line.points[i], line.points[i + 1], gap.at);
      if (!s) continue;
      const double length = (line.points[i + 1] - line.points[i]).norm();
      if (*s - 0.5 * gap.width >= 0.0 && *s + 0.5 * gap.width <= length) return true;
    }
  }
  return false;
}

Building read_building(const YAML::Node& root) {
  const Entry entry(root, "world",
                    {"name", "ceiling", "rooms", "walls", "glass", "openings", "doors", "furniture",
                     "obstacles"});
  Building building;
  building.name = entry.text("name");
  if (entry.has("ceiling")) building.ceiling = entry.number("ceiling", 2.2, 30.0);
  const auto each = [&](const char* key, auto&& take) {
    if (!entry.has(key)) return;
    for (const YAML::Node& node : entry.list(key)) take(node);
  };
  std::set<std::string> names;
  std::set<std::string> room_names;
  each("rooms", [&](const YAML::Node& node) {
    building.rooms.push_back(parse_room(node));
    insist_on_new_name(room_names, building.rooms.back(), node);
  });
  each("walls", [&](const YAML::Node& node) {
    building.walls.push_back(parse_wall(node, Material::kSolid));
    insist_on_new_name(names, building.walls.back(), node);
  });
  each("glass", [&](const YAML::Node& node) {
    building.walls.push_back(parse_wall(node, Material::kGlass));
    insist_on_new_name(names, building.walls.back(), node);
  });
  std::set<std::string> door_names;
  for (const bool door : {false, true}) {
    each(door ? "doors" : "openings", [&](const YAML::Node& node) {
      building.gaps.push_back(parse_gap(node, door));
      if (door) insist_on_new_name(door_names, building.gaps.back(), node);
      if (!lies_on_a_wall(building, building.gaps.back())) {
        throw ParseError(node.Mark(),
                         "'at' must lie on the middle line of a wall, with half of "
                         "the width on either side");
      }
    });
  }
  for (const bool mapped : {true, false}) {
    each(mapped ? "furniture" : "obstacles", [&](const YAML::Node& node) {
      for (Thing& thing : parse_furniture(node)) {
        insist_on_new_name(names, thing, node);
        (mapped ? building.furniture : building.obstacles).push_back(std::move(thing));
      }
    });
  }
  return building;
}

std::vector<PersonPlan> read_people(const YAML::Node& root) {
  const Entry entry(root, "people file", {"people"});
  std::vector<PersonPlan> people;
  std::set<std::string> names;
  for (const YAML::Node& node : entry.list("people")) {
    people.push_back(parse_person(node));
    insist_on_new_name(names, people.back(), node);
  }
  return people;
}

template <class Value>
Result<Value> parse(const std::string& text, const std::string& file,
                    Value (*read)(const YAML::Node&)) {
  try {
    return read(YAML::Load(text));
  } catch (const ParseError& error) {
    return Error{file + ":" + error.what()};
  } catch (const YAML::Exception& error) {
    return Error{file + ":" + std::to_string(error.mark.line + 1) +
                 ": not valid YAML: " + error.msg};
  }
}

Result<std::string> read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Error{path + ": cannot be opened"};
  std::string text(kLargestFile + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) return Error{path + ": cannot be read"};
  if (text.size() > kLargestFile) return Error{path + ": larger than 4 MiB"};
  return text;
}

// The wall from `from` to `to` [m along the line], extended at the ends of the polyline so that
// corners close.
void add_stretch(const WallLine& line, const Point2& a, const Point2& b, double from, double to,
                 double ceiling, std::vector<Thing>& things) {
  if (to - from < 1e-6) return;
  const Point2 along = (b - a).normalized();
  const Point2 middle = a + 0.5 * (from + to) * along;
  Thing thing = box(line.name, {middle.x(), middle.y(), std::atan2(along.y(), along.x())},
                    to - from, line.thickness, 0.0, ceiling);
  thing.material = line.material;
  things.push_back(std::move(thing));
}

void add_wall_leg(const WallLine& line, std::size_t leg, const Building& building,
                  std::vector<Thing>& things) {
  const Point2& a = line.points[leg];
  const Point2& b = line.points[leg + 1];
  const Point2 along = (b - a).normalized();
  const double yaw = std::atan2(along.y(), along.x());
  std::vector<std::pair<double, const Gap*>> gaps;
  for (const Gap& gap : building.gaps) {
    if (const auto s = place_on(a, b, gap.at)) gaps.emplace_back(*s, &gap);
  }
  std::sort(gaps.begin(), gaps.end());

  double from = -0.5 * line.thickness;
  for (const auto& [s, gap] : gaps) {
    add_stretch(line, a, b, from, s - 0.5 * gap->width, building.ceiling, things);
    from = s + 0.5 * gap->width;
    if (!gap->door) continue;
    const Pose2 pose{gap->at.x(), gap->at.y(), yaw};
    things.push_back(box("lintel " + gap->name, pose, gap->width, line.thickness, kDoorHeight,
                         building.ceiling));
    if (!gap->open) {
      constexpr double kLeaf = 0.05;
      things.push_back(box("door " + gap->name, pose, gap->width, kLeaf, 0.0, building.ceiling));
    }
  }
  add_stretch(line, a, b, from, (b - a).norm() + 0.5 * line.thickness, building.ceiling, things);
}

}  // namespace

Result<Building> parse_building(const std::string& text, const std::string& file) {
  return parse(text, file, read_building);
}

Result<Building> load_building(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return Error{text.error()};
  return parse_building(*text, path);
}

Result<std::vector<PersonPlan>> parse_people(const std::string& text, const std::string& file) {
  return parse(text, file, read_people);
}

Result<std::vector<PersonPlan>> load_people(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return Error{text.error()};
  return parse_people(*text, path);
}

std::vector<Thing> construct(const Building& building) {
  std::vector<Thing> things;
  for (const WallLine& line : building.walls) {
    for (std::size_t leg = 0; leg + 1 < line.points.size(); ++leg) {
      add_wall_leg(line, leg, building, things);
    }
  }
  things.insert(things.end(), building.furniture.begin(), building.furniture.end());
  things.insert(things.end(), building.obstacles.begin(), building.obstacles.end());
  return things;
}

}  // namespace usher::world
