#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "foundation/geometry/pose3.hpp"
#include "foundation/imaging/depth_image.hpp"
#include "foundation/result/result.hpp"
#include "simulation/rendering/core/body.hpp"

namespace usher::rendering {

/// What infrared light makes of a surface.
enum class Material : std::uint8_t {
  kMatte = 0,
  kGlass = 1,  ///< lets it through
  kVinyl = 2,  ///< a floor that mirrors at grazing angles
  kDark = 3,   ///< returns little
};

/// A convex upright thing; one that lies below the floor (top <= 0) is a pit in it.
struct Prism {
  std::vector<geometry::Point2> outline;  ///< [m] counter-clockwise, at least three
  double bottom = 0.0;                    ///< [m]
  double top = 1.0;                       ///< [m]
  Material material = Material::kMatte;
};

/// Everything that stands still, above a floor at height 0 and below a flat ceiling.
struct Model {
  std::vector<Prism> prisms;
  double ceiling = 2.7;  ///< [m]
  Material floor = Material::kVinyl;
};

/// A pinhole camera's image; see imaging::Intrinsics for the convention.
struct Lens {
  int width = 512;
  int height = 424;
  double fx = 365.46, fy = 365.46;  ///< [pixels]
  double cx = 255.5, cy = 211.5;    ///< [pixels]
};
/// What those who get its images know of it.
inline imaging::Intrinsics intrinsics_of(const Lens& lens) {
  return {lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy};
}

/// What the rays of one image met, pixel by pixel from the top left.
struct Hits {
  int width = 0, height = 0;
  std::vector<float> depth;            ///< [m] along the optical axis; 0: nothing within reach
  std::vector<float> cosine;           ///< between the ray and the surface's normal, in [0, 1]
  std::vector<std::uint8_t> material;  ///< Material
  std::vector<std::int16_t> body;      ///< index of the body that was hit; -1: none
};

/// Casts the rays of depth cameras into a model, on Embree, and into people, by LimbRays.
/// Deterministic: the same calls give the same bits on one machine. The rays of a 512 x 424 image
/// take 6 ms (usher bench rendering); not thread-safe.
class Renderer {
 public:
  /// The error says what of the model cannot be (an outline with too few or infinite points).
  static Result<Renderer> make(const Model& model);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// The people from now on.
  void place(std::span<const Body> bodies);

  /// world_T_camera: x along the optical axis, y left, z up. `reach` [m] along the axis.
  void render(const Lens& lens, const geometry::Pose3& world_T_camera, double reach, Hits& hits);

  /// Length of the way [m] from a point in a direction (unit length) to the first surface, that
  /// light which mirrors there would go; infinity when there is none within `reach`.
  double distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double reach);

 private:
  struct Scene;
  static void take(const Scene& scene, const void* rays, int i, float reach, std::size_t pixel,
                   Hits& hits);
  void show_people(const Lens& lens, const geometry::Pose3& world_T_camera, float reach,
                   Hits& hits);
  explicit Renderer(std::unique_ptr<Scene> scene);
  std::unique_ptr<Scene> scene_;
};

}  // namespace usher::rendering
