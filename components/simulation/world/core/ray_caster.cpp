#include "simulation/world/core/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace usher::world {
namespace {

constexpr int kBlock = 16;  // beams whose farthest hit is kept together
constexpr float kPi = static_cast<float>(geometry::kPi);
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Within 3e-4 rad of atan2, in (-pi, pi]; enough to find the beams to try.
constexpr float kAngleError = 3e-4f;
float quick_atan2(float y, float x) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float a = std::min(ax, ay) / (std::max(ax, ay) + 1e-30f);
  const float s = a * a;
  float angle = ((-0.0464964749f * s + 0.15931422f) * s - 0.327622764f) * s * a + a;
  if (ay > ax) angle = 0.5f * kPi - angle;
  if (x < 0.0f) angle = kPi - angle;
  return y < 0.0f ? -angle : angle;
}

float cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Writes a wall's piece from a to b, both in beam coordinates, into the beams that it is nearest
// to.
void write_piece(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float numerator,
                 const float* cosines, const float* sines, int count, std::int32_t id, float* range,
                 std::int32_t* what) {
  const float ax = a.x();
  const float ay = a.y();
  const float bx = b.x();
  const float by = b.y();
  for (int i = 0; i < count; ++i) {
    const float past_a = cosines[i] * ay - sines[i] * ax;
    const float past_b = cosines[i] * by - sines[i] * bx;
    const float t = numerator / (past_b - past_a);
    const bool hit = (past_a >= 0.0f) & (past_b <= 0.0f) & (t < range[i]);
    range[i] = hit ? t : range[i];
    what[i] = hit ? id : what[i];
  }
}

}  // namespace

Fan::Fan(double angle_min, double increment, int count)
    : angle_min_(angle_min), increment_(increment) {
  assert(count >= 1 && increment > 0.0 && increment * count <= 2.0 * geometry::kPi);
  for (int i = 0; i < count; ++i) {
    cos_.push_back(static_cast<float>(std::cos(angle_min + i * increment)));
    sin_.push_back(static_cast<float>(std::sin(angle_min + i * increment)));
  }
}

void RayCaster::cast(const Scene& scene, const Fan& fan, const geometry::Pose3& world_T_sensor,
                     const RayOptions& options, std::span<const Mover> movers, FanHits& hits) {
  assert(world_T_sensor.finite() && options.max_range > 0.0 && options.max_range <= 60.0);
  assert(options.glass_flags.empty() ||
         options.glass_flags.size() == static_cast<std::size_t>(fan.count()));
  fan_ = &fan;
  options_ = &options;
  hits_ = &hits;
  origin_ = world_T_sensor.translation.cast<float>();
  const Eigen::Matrix3f rotation = world_T_sensor.rotation.toRotationMatrix().cast<float>();
  plane_ = rotation.topLeftCorner<2, 2>();
  slope_x_ = rotation(2, 0);
  slope_y_ = rotation(2, 1);
  const float determinant = plane_.determinant();
  assert(determinant > 0.08f);
  unplane_ = plane_.inverse();
  const float squares = unplane_.squaredNorm();
  stretch_ = std::sqrt(
      0.5f * (squares +
              std::sqrt(std::max(0.0f, squares * squares - 4.0f / (determinant * determinant)))));

  const auto count = static_cast<std::size_t>(fan.count());
  hits.range.resize(count);
  hits.what.resize(count);
  farthest_.resize((count + kBlock - 1) / kBlock);
  cast_background(scene);
  refresh({{{0, fan.count() - 1}, {0, -1}}});
  cast_walls(scene);
  cast_prisms(scene, movers);
}

RayCaster::Intervals RayCaster::beams_between(float low, float high) const {
  const float per_angle = 1.0f / static_cast<float>(fan_->increment());
  const float turn = 2.0f * kPi;
  const int last_beam = fan_->count() - 1;
  float from = low - static_cast<float>(fan_->angle_min()) - kAngleError;
  while (from < 0.0f) from += turn;
  while (from >= turn) from -= turn;
  const float to = from + (high - low) + 2.0f * kAngleError;
  Intervals beams{{{0, -1}, {0, -1}}};
  const float last_angle = static_cast<float>(last_beam);
  if (from * per_angle <= last_angle) {
    beams.part[0] = {static_cast<int>(from * per_angle),
                     static_cast<int>(std::min(to * per_angle, last_angle - 0.5f)) + 1};
    beams.part[0].last = std::min(beams.part[0].last, last_beam);
  }
  if (to >= turn) {
    const float beyond = (to - turn) * per_angle;
    beams.part[1] = {0, std::min(static_cast<int>(std::min(beyond, last_angle)) + 1, last_beam)};
  }
  return beams;
}

RayCaster::Intervals RayCaster::beams_around(const Eigen::Vector2f& center, float radius) const {
  const float away = center.norm();
  if (away <= radius) return {{{0, fan_->count() - 1}, {0, -1}}};
  const float half = std::asin(radius / away);
  const float angle = quick_atan2(center.y(), center.x());
  return beams_between(angle - half, angle + half);
}

bool RayCaster::hidden(const Intervals& beams, float distance) const {
  for (const Interval& part : beams.part) {
    if (part.first > part.last) continue;
    for (int block = part.first / kBlock; block <= part.last / kBlock; ++block) {
      if (farthest_[static_cast<std::size_t>(block)] > distance) return false;
    }
  }
  return true;
}

void RayCaster::refresh(const Intervals& beams) {
  for (const Interval& part : beams.part) {
    if (part.first > part.last) continue;
    for (int block = part.first / kBlock; block <= part.last / kBlock; ++block) {
      const float* begin = hits_->range.data() + block * kBlock;
      const float* end = hits_->range.data() + std::min((block + 1) * kBlock, fan_->count());
      // Positive floats are ordered like their bits, and a maximum of integers is vectorized.
      std::int32_t farthest = 0;
      for (; begin != end; ++begin)
        farthest = std::max(farthest, std::bit_cast<std::int32_t>(*begin));
      farthest_[static_cast<std::size_t>(block)] = std::bit_cast<float>(farthest);
    }
  }
}

void RayCaster::cast_background(const Scene& scene) {
  std::fill(hits_->range.begin(), hits_->range.end(), static_cast<float>(options_->max_range));
  std::fill(hits_->what.begin(), hits_->what.end(), kNothing);
  if (std::abs(slope_x_) + std::abs(slope_y_) < 1e-6f) return;
  const float room = static_cast<float>(scene.ceiling()) - origin_.z();
  for (std::size_t i = 0; i < hits_->range.size(); ++i) {
    const float slope = fan_->cosines()[i] * slope_x_ + fan_->sines()[i] * slope_y_;
    const bool down = slope < 0.0f;
    const float t = (down ? -origin_.z() : room) / slope;
    if (t > 0.0f && t < hits_->range[i]) {
      hits_->range[i] = t;
      hits_->what[i] = down ? kFloor : kCeiling;
    }
  }
}

void RayCaster::cast_prisms(const Scene& scene, std::span<const Mover> movers) {
  const Eigen::Vector2f origin = origin_.head<2>();
  const float max_range = static_cast<float>(options_->max_range);
  for (const Scene::Bound& bound : scene.prisms_) {
    const Eigen::Vector2f center = unplane_ * (bound.center.cast<float>() - origin);
    const float radius = static_cast<float>(bound.radius) * stretch_;
    if (center.squaredNorm() > (max_range + radius) * (max_range + radius)) continue;
    const Intervals beams = beams_around(center, radius);
    if (hidden(beams, center.norm() - radius)) continue;
    const Thing& thing = scene.things_[static_cast<std::size_t>(bound.thing)];
    if (thing.outline.empty()) {
      cast_disc(thing.center, thing.radius, thing.bottom, thing.top,
                thing.material == Material::kGlass, bound.thing, beams);
    } else {
      cast_outline(thing, bound.thing, center);
    }
  }
  auto id = static_cast<std::int32_t>(scene.things_.size());
  for (const Mover& mover : movers) {
    const Eigen::Vector2f center = unplane_ * (mover.center.cast<float>() - origin);
    const Intervals beams = beams_around(center, static_cast<float>(mover.radius) * stretch_);
    cast_disc(mover.center, mover.radius, 0.0, mover.top, false, id++, beams);
  }
}

bool RayCaster::passes_glass(int beam, float cosine) const {
  if (options_->glass_flags.empty()) return false;
  return options_->glass_flags[static_cast<std::size_t>(beam)] == 0 ||
         cosine < static_cast<float>(options_->glass_cosine);
}

// A beam is over the thing's outline from `enter` to `leave`: it meets the side, the top, the
// bottom or nothing.
void RayCaster::offer(int beam, float enter, float leave, float bottom, float top,
                      std::int32_t id) {
  const auto i = static_cast<std::size_t>(beam);
  const float slope = fan_->cosines()[i] * slope_x_ + fan_->sines()[i] * slope_y_;
  const float height = origin_.z() + enter * slope;
  float t = enter;
  if (height > top || height < bottom) {
    t = ((height > top ? top : bottom) - origin_.z()) / slope;
    if (!(t >= enter && t <= leave)) return;
  }
  if (t < hits_->range[i]) {
    hits_->range[i] = t;
    hits_->what[i] = id;
  }
}

void RayCaster::cast_outline(const Thing& thing, std::int32_t id, const Eigen::Vector2f& center) {
  // Each side as a line in beam coordinates: its direction, and its cross product with the sensor.
  struct Side {
    float x = 0.0f, y = 0.0f, numerator = 0.0f;
  };
  const std::size_t corners = thing.outline.size();
  const auto in_plane = [&](const Point2& p) -> Eigen::Vector2f {
    return unplane_ * (p.cast<float>() - origin_.head<2>());
  };
  std::array<Side, Thing::kMaxCorners> sides{};
  float low = 0.0f;   // bearings of the corners
  float high = 0.0f;  // from the middle
  for (std::size_t k = 0; k < corners; ++k) {
    const Eigen::Vector2f a = in_plane(thing.outline[k]);
    const Eigen::Vector2f b = in_plane(thing.outline[(k + 1) % corners]);
    sides[k] = {b.x() - a.x(), b.y() - a.y(), cross(a, b)};
    const float bearing = quick_atan2(cross(center, a), center.dot(a));
    low = std::min(low, bearing);
    high = std::max(high, bearing);
  }
  const float middle = quick_atan2(center.y(), center.x());
  const Intervals beams = beams_between(middle + low - kAngleError, middle + high + kAngleError);

  for (const Interval& part : beams.part) {
    for (int beam = part.first; beam <= part.last; ++beam) {
      const float cosine = fan_->cosines()[static_cast<std::size_t>(beam)];
      const float sine = fan_->sines()[static_cast<std::size_t>(beam)];
      float enter = 0.0f;
      float leave = kInfinity;
      const Side* entry = nullptr;
      for (std::size_t k = 0; k < corners; ++k) {
        const Side& side = sides[k];
        const float denominator = cosine * side.y - sine * side.x;
        const float t = side.numerator / denominator;
        if (denominator < 0.0f) {
          if (t > enter) enter = t, entry = &side;
        } else if (denominator > 0.0f) {
          leave = std::min(leave, t);
        } else if (side.numerator < 0.0f) {
          leave = -1.0f;  // runs beside the outline
        }
      }
      if (entry == nullptr || enter > leave) continue;
      if (thing.material == Material::kGlass) {
        const float away = -entry->numerator / std::hypot(entry->x, entry->y);
        if (passes_glass(beam, away / enter)) continue;
      }
      offer(beam, enter, leave, static_cast<float>(thing.bottom), static_cast<float>(thing.top),
            id);
    }
  }
}

void RayCaster::cast_disc(const Point2& center, double radius, double bottom, double top,
                          bool glass, std::int32_t id, const Intervals& beams) {
  const Eigen::Vector2f to = center.cast<float>() - origin_.head<2>();
  const float outside = to.squaredNorm() - static_cast<float>(radius * radius);
  if (outside <= 0.0f) return;
  for (const Interval& part : beams.part) {
    for (int beam = part.first; beam <= part.last; ++beam) {
      const auto i = static_cast<std::size_t>(beam);
      const Eigen::Vector2f step = plane_ * Eigen::Vector2f(fan_->cosines()[i], fan_->sines()[i]);
      const float a = step.squaredNorm();
      const float b = step.dot(to);
      const float root2 = b * b - a * outside;
      if (root2 < 0.0f || b <= 0.0f) continue;
      const float root = std::sqrt(root2);
      if (glass && passes_glass(beam, root / (static_cast<float>(radius) * std::sqrt(a)))) continue;
      offer(beam, (b - root) / a, (b + root) / a, static_cast<float>(bottom),
            static_cast<float>(top), id);
    }
  }
}

void RayCaster::cast_walls(const Scene& scene) {
  const Eigen::Vector2f origin = origin_.head<2>();
  const grid::GridGeometry& cells = scene.cells_;
  const grid::Cell home = cells.cell_at(origin_.x(), origin_.y());
  const float half = 0.5f * static_cast<float>(cells.resolution);
  float farthest = *std::max_element(farthest_.begin(), farthest_.end());
  for (const Scene::Offset& offset : scene.offsets_) {
    if (offset.reach >= farthest) break;
    const grid::Cell cell{home.x + offset.x, home.y + offset.y};
    if (!cells.contains(cell)) continue;
    const std::size_t index = cells.index(cell);
    if (scene.first_[index] == scene.first_[index + 1]) continue;

    const Eigen::Vector2f middle = cells.center(cell).cast<float>() - origin;
    const Eigen::Vector2f gap = (middle.cwiseAbs().array() - half).max(0.0f);
    const float distance = gap.norm();
    if (distance >= farthest) continue;
    const Intervals beams =
        beams_around(unplane_ * middle, half * std::numbers::sqrt2_v<float> * stretch_);
    if (hidden(beams, distance)) continue;
    for (std::uint32_t i = scene.first_[index]; i < scene.first_[index + 1]; ++i) {
      cast_piece(scene.pieces_[i]);
    }
    refresh(beams);
    farthest = *std::max_element(farthest_.begin(), farthest_.end());
  }
}

void RayCaster::cast_piece(const Scene::Piece& piece) {
  const Eigen::Vector2f origin = origin_.head<2>();
  const Eigen::Vector2f a = unplane_ * (Eigen::Vector2f(piece.ax, piece.ay) - origin);
  const Eigen::Vector2f b = unplane_ * (Eigen::Vector2f(piece.bx, piece.by) - origin);
  const float numerator = cross(a, b);
  if (numerator >= 0.0f) return;  // seen from inside
  const float from = quick_atan2(b.y(), b.x());
  float to = quick_atan2(a.y(), a.x());
  if (to < from) to += 2.0f * kPi;
  const Intervals beams = beams_between(from, to);

  const float away = -numerator / (b - a).norm();
  const bool glass = piece.glass && !options_->glass_flags.empty();
  for (const Interval& part : beams.part) {
    if (part.first > part.last) continue;
    if (!glass) {
      write_piece(a, b, numerator, fan_->cosines().data() + part.first,
                  fan_->sines().data() + part.first, part.last - part.first + 1, piece.thing,
                  hits_->range.data() + part.first, hits_->what.data() + part.first);
      continue;
    }
    for (int beam = part.first; beam <= part.last; ++beam) {
      const auto i = static_cast<std::size_t>(beam);
      float t = hits_->range[i];
      std::int32_t what = hits_->what[i];
      write_piece(a, b, numerator, fan_->cosines().data() + i, fan_->sines().data() + i, 1,
                  piece.thing, &t, &what);
      if (t < hits_->range[i] && !passes_glass(beam, away / t)) {
        hits_->range[i] = t;
        hits_->what[i] = what;
      }
    }
  }
}

}  // namespace usher::world
