#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/rendering/core/light.hpp"
#include "simulation/rendering/core/renderer.hpp"
#include "simulation/rendering/core/texture.hpp"

namespace usher::rendering {

/// A picture on an upright surface: a poster on a wall, the front of a cabinet.
struct Poster {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< [m] in world
  double yaw = 0.0;                                  ///< [rad] where it looks
  double side = 0.5;                                 ///< [m]
  std::size_t picture = 0;                           ///< index of its texture
};

/// The image of a color camera in which people have clothes and faces, and walls pictures: over
/// what paint() makes of the hits. Deterministic; no allocation after the first image.
class Painter {
 public:
  /// The faces of people by their number, in turn; none: heads without faces.
  explicit Painter(std::vector<Texture> faces) : faces_(std::move(faces)) {}

  void hang(std::vector<Poster> posters, std::vector<Texture> pictures);

  /// `hits` are what the rays of this lens and pose met, `bodies` those of that moment; `gains` is
  /// what the camera makes of the light on the clothes of each, white where it says nothing. 3
  /// bytes a pixel.
  void paint(const Hits& hits, const Lens& lens, const geometry::Pose3& world_T_camera,
             std::span<const Body> bodies, std::span<const Gains> gains,
             std::vector<std::uint8_t>& rgb);

 private:
  /// A head by its middle and axes.
  struct Head {
    Eigen::Vector3f middle, forward, left, up;
    float radius = 0.0F;
    const Texture* face = nullptr;
  };
  /// The clothes of a body: the colors of each brightness {0..1}.
  struct Dress {
    static constexpr std::size_t kShades = 64;
    using Shades = std::array<std::array<std::uint8_t, 3>, kShades>;
    Waist waist;
    bool worn = false;
    Shades upper, legs;
  };
  static void shade(const Clothes::Color& color, const Gains& gains, Dress::Shades& shades);
  void dress(std::span<const Body> bodies, std::span<const Gains> gains);
  static void paint_clothes(const Dress& dress, const Eigen::Vector3f& point, float cosine,
                            std::uint8_t* rgb);
  void find_heads(std::span<const Body> bodies);
  static bool paint_head(const Head& head, const Eigen::Vector3f& point, float pixel,
                         Texture::Color& color);
  bool paint_poster(const Eigen::Vector3f& point, float pixel, Texture::Color& color) const;

  std::vector<Texture> faces_, pictures_;
  std::vector<Poster> posters_;
  std::vector<Head> heads_;
  std::vector<Dress> dresses_;
  std::vector<Limb> limbs_;
};

/// Where the middle of a body's head is [m] in world, and its radius [m].
struct HeadPlace {
  Eigen::Vector3d middle;
  double radius = 0.0;
};
HeadPlace head_of(const Body& body);

}  // namespace usher::rendering
