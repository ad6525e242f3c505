#include "simulation/rendering/core/renderer.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "simulation/rendering/core/limb_rays.hpp"

namespace usher::rendering {

namespace {

using geometry::Point2;

constexpr int kPacket = 8;
constexpr int kRun = static_cast<int>(LimbHits::kMost);
constexpr double kBeside = 0.01;  // [m] where the neighbour of a pit's wall is looked for
constexpr std::size_t kMaxCorners = 64;

struct Triangles {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::array<std::uint32_t, 3>> corners;

  std::uint32_t add(const Point2& p, double z) {
    points.push_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  void wall(const Point2& a, const Point2& b, double bottom, double top) {
    const auto i = add(a, bottom);
    add(b, bottom), add(b, top), add(a, top);
    corners.push_back({i, i + 1, i + 2});
    corners.push_back({i, i + 2, i + 3});
  }
  void lid(std::span<const Point2> outline, double z) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Point2& p : outline) add(p, z);
    for (std::uint32_t i = 2; i < outline.size(); ++i)
      corners.push_back({first, first + i - 1, first + i});
  }
};

bool inside(std::span<const Point2> outline, const Point2& p) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point2 edge = outline[(i + 1) % outline.size()] - outline[i];
    const Point2 to = p - outline[i];
    if (edge.x() * to.y() - edge.y() * to.x() < 0.0) return false;
  }
  return true;
}

bool is_pit(const Prism& prism) { return prism.top <= 0.0; }

/// How deep the floor lies at a point; 0 beside all pits.
double depth_of_floor(std::span<const Prism> pits, const Point2& p) {
  double depth = 0.0;
  for (const Prism& pit : pits) {
    if (inside(pit.outline, p)) depth = std::max(depth, -pit.bottom);
  }
  return depth;
}

void add_pit(std::span<const Prism> pits, const Prism& pit, Triangles& triangles) {
  triangles.lid(pit.outline, pit.bottom);
  for (std::size_t i = 0; i < pit.outline.size(); ++i) {
    const Point2& a = pit.outline[i];
    const Point2& b = pit.outline[(i + 1) % pit.outline.size()];
    const Point2 outward = Point2(b.y() - a.y(), a.x() - b.x()).normalized();
    const double beside = depth_of_floor(pits, 0.5 * (a + b) + kBeside * outward);
    if (beside < -pit.bottom) triangles.wall(a, b, pit.bottom, -beside);
  }
}

void add_prism(const Prism& prism, Triangles& triangles) {
  triangles.lid(prism.outline, prism.top);
  if (prism.bottom > 0.0) triangles.lid(prism.outline, prism.bottom);
  for (std::size_t i = 0; i < prism.outline.size(); ++i) {
    triangles.wall(prism.outline[i], prism.outline[(i + 1) % prism.outline.size()], prism.bottom,
                   prism.top);
  }
}

Status check(const Model& model) {
  if (!(model.ceiling > 0.5 && model.ceiling < 100.0))
    return Error{"the ceiling must be in (0.5, 100) m, got " + std::to_string(model.ceiling)};
  for (std::size_t i = 0; i < model.prisms.size(); ++i) {
    const Prism& prism = model.prisms[i];
    const std::string name = "prism " + std::to_string(i);
    if (prism.outline.size() < 3 || prism.outline.size() > kMaxCorners)
      return Error{name + ": an outline has 3 to 64 corners, got " +
                   std::to_string(prism.outline.size())};
    if (!(prism.bottom < prism.top) || !std::isfinite(prism.bottom) || !std::isfinite(prism.top))
      return Error{name + ": bottom must be below top, got " + std::to_string(prism.bottom) +
                   " and " + std::to_string(prism.top)};
    for (const Point2& p : prism.outline) {
      if (!p.allFinite()) return Error{name + ": its outline must be finite"};
    }
  }
  return {};
}

/// Everything of somebody is in this ball.
struct Ball {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0.0F;

  bool misses(const Eigen::Vector3f& from, const Eigen::Vector3f& unit) const {
    const Eigen::Vector3f to = center - from;
    const float along = to.dot(unit);
    const float beside = to.squaredNorm() - along * along;
    return beside > radius * radius || along < -radius;
  }
};

Ball ball_around(std::span<const Limb> limbs) {
  Eigen::AlignedBox3f box;
  for (const Limb& limb : limbs) {
    const auto add = [&](const Eigen::Vector3f& middle, float radius) {
      box.extend(middle - Eigen::Vector3f::Constant(radius));
      box.extend(middle + Eigen::Vector3f::Constant(radius));
    };
    add(limb.from, limb.from_radius);
    add(limb.to, limb.to_radius);
  }
  return box.isEmpty() ? Ball{} : Ball{box.center(), 0.5F * box.diagonal().norm()};
}

struct Somebody {
  std::vector<Limb> limbs;
  std::vector<Ball> around_limb;
  Ball around;
};

/// Pixels of an image; right and bottom are past the last ones.
struct Window {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// Where a limb can be seen: the hull of its balls' images.
Window window_of(const Limb& limb, const Lens& lens, const Eigen::Matrix3f& turn,
                 const Eigen::Vector3f& origin) {
  constexpr float kFar = 1e6F;
  Eigen::Vector2f least(kFar, kFar), most(-kFar, -kFar);  // right and down of the axis at 1 m
  int behind = 0;
  bool around = false;
  const auto add = [&](const Eigen::Vector3f& middle, float radius) {
    const Eigen::Vector3f p = turn.transpose() * (middle - origin);
    const float ahead = p.x();
    const Eigen::Array2f beside(-p.y(), -p.z());
    const float square = ahead * ahead - radius * radius;
    behind += ahead <= -radius ? 1 : 0;
    around = around || ahead <= radius || square <= 0.0F;
    if (around) return;
    const Eigen::Array2f half = radius * (square + beside.square()).sqrt();
    least = least.array().min((beside * ahead - half) / square);
    most = most.array().max((beside * ahead + half) / square);
  };
  add(limb.from, limb.from_radius);
  add(limb.to, limb.to_radius);
  if (behind == 2) return {};
  if (around) return {0, 0, lens.width, lens.height};
  const auto pixel = [](double center, double focal, float at, int size, int past) {
    const double found = center + focal * static_cast<double>(at);
    return static_cast<int>(std::clamp(std::floor(found) + past, 0.0, static_cast<double>(size)));
  };
  return {pixel(lens.cx, lens.fx, least.x(), lens.width, 0),
          pixel(lens.cy, lens.fy, least.y(), lens.height, 0),
          pixel(lens.cx, lens.fx, most.x(), lens.width, 2),
          pixel(lens.cy, lens.fy, most.y(), lens.height, 2)};
}

template <class T>
void fill_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                 const std::vector<T>& values) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(T), values.size());
  std::copy(values.begin(), values.end(), static_cast<T*>(buffer));
}

}  // namespace

struct Renderer::Scene {
  RTCDevice device = nullptr;
  RTCScene still = nullptr;         // what stands still
  std::vector<Material> materials;  // of its geometries
  std::vector<Prism> pits;
  double ceiling = 2.7;
  Material floor = Material::kVinyl;
  std::vector<Somebody> people;
  std::vector<float> columns;  // [m] to the right of the axis at 1 m, of an image

  ~Scene() {
    if (still != nullptr) rtcReleaseScene(still);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add(Material material, const Triangles& triangles) {
    if (triangles.corners.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, triangles.points);
    fill_buffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(still, geometry);
    rtcReleaseGeometry(geometry);
    materials.push_back(material);
  }

  /// Distance along a ray to floor or ceiling; its direction needs no length.
  float plane(const Eigen::Vector3f& from, float x, float y, float z) const {
    constexpr float kNever = std::numeric_limits<float>::infinity();
    if (z > 0.0F) return (static_cast<float>(ceiling) - from.z()) / z;
    if (!(z < 0.0F) || from.z() < 0.0F) return kNever;
    const float t = -from.z() / z;
    if (!pits.empty()) {
      const Eigen::Vector2f p = from.head<2>() + t * Eigen::Vector2f(x, y);
      if (depth_of_floor(pits, p.cast<double>()) > 0.0) return kNever;
    }
    return t;
  }
};

Renderer::Renderer(std::unique_ptr<Scene> scene) : scene_(std::move(scene)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::make(const Model& model) {
  if (const auto status = check(model); !status) return Error{status.error()};
  auto scene = std::make_unique<Scene>();
  scene->device = rtcNewDevice("threads=1,set_affinity=0");
  if (scene->device == nullptr) return Error{"Embree refuses this processor"};
  scene->still = rtcNewScene(scene->device);
  scene->ceiling = model.ceiling;
  scene->floor = model.floor;
  for (const Prism& prism : model.prisms) {
    if (is_pit(prism)) scene->pits.push_back(prism);
  }
  for (const Material material :
       {Material::kMatte, Material::kGlass, Material::kVinyl, Material::kDark}) {
    Triangles triangles;
    for (const Prism& prism : model.prisms) {
      if (prism.material != material || material == Material::kGlass) continue;
      is_pit(prism) ? add_pit(scene->pits, prism, triangles) : add_prism(prism, triangles);
    }
    scene->add(material, triangles);
  }
  rtcSetSceneBuildQuality(scene->still, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(scene->still);
  return Renderer(std::move(scene));
}

void Renderer::place(std::span<const Body> bodies) {
  scene_->people.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Somebody& somebody = scene_->people[i];
    make_limbs(bodies[i], somebody.limbs);
    somebody.around = ball_around(somebody.limbs);
    somebody.around_limb.clear();
    for (const Limb& limb : somebody.limbs) somebody.around_limb.push_back(ball_around({&limb, 1}));
  }
}

/// What ray i of a packet met.
void Renderer::take(const Scene& s, const void* rays, int i, float reach, std::size_t pixel,
                    Hits& hits) {
  const auto& packet = *static_cast<const RTCRayHit8*>(rays);
  const Eigen::Vector3f along(packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]);
  const float t = packet.ray.tfar[i];
  if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
    if (!(t < reach)) return;  // neither floor nor ceiling
    hits.depth[pixel] = t;
    hits.cosine[pixel] = std::abs(along.z()) / along.norm();
    hits.material[pixel] = static_cast<std::uint8_t>(along.z() < 0.0F ? s.floor : Material::kMatte);
    return;
  }
  const Eigen::Vector3f normal(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
  hits.depth[pixel] = t;
  hits.cosine[pixel] = std::min(
      1.0F, std::abs(along.dot(normal)) / std::sqrt(along.squaredNorm() * normal.squaredNorm()));
  hits.material[pixel] = static_cast<std::uint8_t>(s.materials[packet.hit.geomID[i]]);
}

void Renderer::render(const Lens& lens, const geometry::Pose3& world_T_camera, double reach,
                      Hits& hits) {
  const Scene& s = *scene_;
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  hits.width = lens.width;
  hits.height = lens.height;
  hits.depth.assign(pixels, 0.0F);
  hits.cosine.assign(pixels, 0.0F);
  hits.material.assign(pixels, 0);
  hits.body.assign(pixels, -1);

  const Eigen::Matrix3f turn = world_T_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3d& from = world_T_camera.translation;
  const Eigen::Vector3f origin = from.cast<float>();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const Eigen::Vector3f down_axis = -turn.col(2), right_axis = -turn.col(1);
  const auto cx = static_cast<float>(lens.cx), per_pixel = static_cast<float>(1.0 / lens.fx);

  alignas(32) RTCRayHit8 packet;
  alignas(32) int valid[kPacket];
  for (int i = 0; i < kPacket; ++i) {
    packet.ray.org_x[i] = origin.x();
    packet.ray.org_y[i] = origin.y();
    packet.ray.org_z[i] = origin.z();
    packet.ray.tnear[i] = packet.ray.time[i] = 0.0F;
    packet.ray.mask[i] = ~0U;
    packet.ray.id[i] = packet.ray.flags[i] = 0;
  }
  for (int row = 0; row < lens.height; ++row) {
    const auto y = static_cast<float>((row - lens.cy) / lens.fy);
    const Eigen::Vector3f start = turn.col(0) + y * down_axis;
    for (int column = 0; column < lens.width; column += kPacket) {
      const int count = std::min(kPacket, lens.width - column);
      for (int i = 0; i < kPacket; ++i) {
        valid[i] = i < count ? -1 : 0;
        // One metre of ray is one metre of depth.
        const float x = (static_cast<float>(column + i) - cx) * per_pixel;
        packet.ray.dir_x[i] = start.x() + x * right_axis.x();
        packet.ray.dir_y[i] = start.y() + x * right_axis.y();
        packet.ray.dir_z[i] = start.z() + x * right_axis.z();
        packet.ray.tfar[i] = std::min(
            static_cast<float>(reach),
            s.plane(origin, packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]));
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid, s.still, &context, &packet);
      const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width) +
                         static_cast<std::size_t>(column);
      for (int i = 0; i < count; ++i)
        take(s, &packet, i, static_cast<float>(reach), first + static_cast<std::size_t>(i), hits);
    }
  }
  show_people(lens, world_T_camera, static_cast<float>(reach), hits);
}

void Renderer::show_people(const Lens& lens, const geometry::Pose3& world_T_camera, float reach,
                           Hits& hits) {
  Scene& s = *scene_;
  s.columns.resize(static_cast<std::size_t>(lens.width));
  for (int column = 0; column < lens.width; ++column)
    s.columns[static_cast<std::size_t>(column)] = static_cast<float>((column - lens.cx) / lens.fx);
  const Eigen::Matrix3f turn = world_T_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_T_camera.translation.cast<float>();
  LimbHits met;
  for (std::size_t number = 0; number < s.people.size(); ++number) {
    for (const Limb& limb : s.people[number].limbs) {
      const Window window = window_of(limb, lens, turn, origin);
      const LimbRays rays(limb, origin);
      for (int row = window.top; row < window.bottom; ++row) {
        const auto y = static_cast<float>((row - lens.cy) / lens.fy);
        const RowOfRays line{turn.col(0) - y * turn.col(2), -turn.col(1)};
        for (int left = window.left; left < window.right; left += kRun) {
          const auto count = static_cast<std::size_t>(std::min(kRun, window.right - left));
          rays.meet(line, std::span(s.columns).subspan(static_cast<std::size_t>(left), count), met);
          const auto first = static_cast<std::size_t>(row * lens.width + left);
          for (std::size_t i = 0; i < count; ++i) {
            const float before = hits.depth[first + i] > 0.0F ? hits.depth[first + i] : reach;
            if (!(met.distance[i] < before)) continue;
            hits.depth[first + i] = met.distance[i];
            hits.cosine[first + i] = std::min(1.0F, met.cosine[i]);
            hits.material[first + i] = static_cast<std::uint8_t>(Material::kMatte);
            hits.body[first + i] = static_cast<std::int16_t>(number);
          }
        }
      }
    }
  }
}

double Renderer::distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                          double reach) {
  const Scene& s = *scene_;
  const Eigen::Vector3f origin = from.cast<float>(), along = direction.cast<float>();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  ray.ray.org_x = origin.x();
  ray.ray.org_y = origin.y();
  ray.ray.org_z = origin.z();
  ray.ray.dir_x = along.x();
  ray.ray.dir_y = along.y();
  ray.ray.dir_z = along.z();
  ray.ray.tfar =
      std::min(static_cast<float>(reach), s.plane(origin, along.x(), along.y(), along.z()));
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(s.still, &context, &ray);
  float nearest = ray.ray.tfar;
  LimbHits met;
  const RowOfRays only{along, Eigen::Vector3f::Zero()};
  constexpr std::array<float, 1> kNumber{0.0F};
  for (const Somebody& somebody : s.people) {
    if (somebody.around.misses(origin, along)) continue;
    for (std::size_t i = 0; i < somebody.limbs.size(); ++i) {
      if (somebody.around_limb[i].misses(origin, along)) continue;
      LimbRays(somebody.limbs[i], origin).meet(only, kNumber, met);
      nearest = std::min(nearest, met.distance[0]);
    }
  }
  return nearest < static_cast<float>(reach) ? static_cast<double>(nearest)
                                             : std::numeric_limits<double>::infinity();
}

}  // namespace usher::rendering
