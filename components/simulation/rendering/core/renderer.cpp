#include "simulation/rendering/core/renderer.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace usher::rendering {

namespace {

using geometry::Point2;

constexpr int kPacket = 8;
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

template <class T>
void fill_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                 const std::vector<T>& values) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(T), values.size());
  std::copy(values.begin(), values.end(), static_cast<T*>(buffer));
}

}  // namespace

struct Renderer::Scene {
  RTCDevice device = nullptr;
  RTCScene still = nullptr;  // what stands still, instanced into `whole`
  RTCScene whole = nullptr;
  RTCGeometry people = nullptr;
  unsigned people_id = RTC_INVALID_GEOMETRY_ID;
  unsigned still_id = 0;
  std::vector<Material> materials;  // of the geometries in `still`
  std::vector<Prism> pits;
  double ceiling = 2.7;
  Material floor = Material::kVinyl;
  std::vector<Limb> limbs, limbs_of_one;
  std::vector<std::int16_t> owner;  // of each limb
  struct Ball {
    float x, y, z, radius;
  };
  std::vector<Ball> balls;
  std::vector<unsigned> indices;

  ~Scene() {
    if (people != nullptr) rtcReleaseGeometry(people);
    if (whole != nullptr) rtcReleaseScene(whole);
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

  scene->whole = rtcNewScene(scene->device);
  rtcSetSceneFlags(scene->whole, RTC_SCENE_FLAG_DYNAMIC);
  RTCGeometry instance = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, scene->still);
  rtcCommitGeometry(instance);
  scene->still_id = rtcAttachGeometry(scene->whole, instance);
  rtcReleaseGeometry(instance);
  rtcCommitScene(scene->whole);
  return Renderer(std::move(scene));
}

void Renderer::place(std::span<const Body> bodies) {
  Scene& s = *scene_;
  if (s.people != nullptr) {
    rtcDetachGeometry(s.whole, s.people_id);
    rtcReleaseGeometry(s.people);
    s.people = nullptr;
  }
  s.limbs.clear();
  s.owner.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    make_limbs(bodies[i], s.limbs_of_one);
    s.limbs.insert(s.limbs.end(), s.limbs_of_one.begin(), s.limbs_of_one.end());
    s.owner.resize(s.limbs.size(), static_cast<std::int16_t>(i));
  }
  if (!s.limbs.empty()) {
    s.balls.clear();
    s.indices.clear();
    for (const Limb& limb : s.limbs) {
      s.indices.push_back(static_cast<unsigned>(s.balls.size()));
      s.balls.push_back({limb.from.x(), limb.from.y(), limb.from.z(), limb.from_radius});
      s.balls.push_back({limb.to.x(), limb.to.y(), limb.to.z(), limb.to_radius});
    }
    s.people = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    fill_buffer(s.people, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, s.balls);
    fill_buffer(s.people, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, s.indices);
    rtcSetGeometryBuildQuality(s.people, RTC_BUILD_QUALITY_LOW);
    rtcCommitGeometry(s.people);
    s.people_id = rtcAttachGeometry(s.whole, s.people);
  }
  rtcCommitScene(s.whole);
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
  if (packet.hit.instID[0][i] == s.still_id) {
    hits.material[pixel] = static_cast<std::uint8_t>(s.materials[packet.hit.geomID[i]]);
  } else {
    hits.body[pixel] = s.owner[packet.hit.primID[i]];
  }
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
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid, s.whole, &context, &packet);
      const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width) +
                         static_cast<std::size_t>(column);
      for (int i = 0; i < count; ++i)
        take(s, &packet, i, static_cast<float>(reach), first + static_cast<std::size_t>(i), hits);
    }
  }
}

double Renderer::distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                          double reach) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(from.x());
  ray.ray.org_y = static_cast<float>(from.y());
  ray.ray.org_z = static_cast<float>(from.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tfar = static_cast<float>(
      std::min(reach, static_cast<double>(scene_->plane(from.cast<float>(), ray.ray.dir_x,
                                                        ray.ray.dir_y, ray.ray.dir_z))));
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->whole, &context, &ray);
  return ray.ray.tfar < static_cast<float>(reach) ? static_cast<double>(ray.ray.tfar)
                                                  : std::numeric_limits<double>::infinity();
}

}  // namespace usher::rendering
