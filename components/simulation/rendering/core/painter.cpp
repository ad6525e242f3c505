#include "simulation/rendering/core/painter.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/imaging/appearance.hpp"
#include "simulation/rendering/core/depth_sensor.hpp"

namespace usher::rendering {

namespace {

constexpr float kHeadReach = 1.2F;  // of the radius: farther points of a body are no head
constexpr float kFaceDown = 1.35F;  // of the radius: chin below the head's middle
constexpr float kFaceUp = 2.0F * static_cast<float>(kFaceAspect) - kFaceDown;  // crown above it
constexpr float kPosterDepth = 0.03F;  // [m] off its surface
constexpr float kAmbient = 0.5F;       // of the light on clothes comes from all sides
constexpr Texture::Color kHair{48, 36, 30};

}  // namespace

HeadPlace head_of(const Body& body) {
  std::vector<Limb> limbs;
  make_limbs(body, limbs);
  const Limb& crown = limbs.back();
  return {crown.from.cast<double>(), static_cast<double>(crown.from_radius)};
}

void Painter::hang(std::vector<Poster> posters, std::vector<Texture> pictures) {
  posters_ = std::move(posters);
  pictures_ = std::move(pictures);
  std::erase_if(posters_, [&](const Poster& p) { return p.picture >= pictures_.size(); });
}

void Painter::find_heads(std::span<const Body> bodies) {
  heads_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    make_limbs(bodies[i], limbs_);
    const Limb& crown = limbs_.back();
    const double yaw = bodies[i].pose.yaw;
    Head head;
    head.middle = crown.from;
    head.radius = crown.from_radius;
    head.up = (crown.to - crown.from).normalized();
    head.left = Eigen::Vector3d(-std::sin(yaw), std::cos(yaw), 0.0).cast<float>();
    head.forward = head.left.cross(head.up);
    head.face = faces_.empty() ? nullptr : &faces_[i % faces_.size()];
    heads_.push_back(head);
  }
}

/// The face lies on the front of the head as if it were projected from ahead.
bool Painter::paint_head(const Head& head, const Eigen::Vector3f& point, float pixel,
                         Texture::Color& color) {
  if (head.face == nullptr) return false;
  const Eigen::Vector3f from = point - head.middle;
  const float up = from.dot(head.up) / head.radius;
  const float left = from.dot(head.left) / head.radius;
  if (std::abs(left) > kHeadReach || up > kHeadReach || up < -kFaceDown) return false;
  if (from.dot(head.forward) <= 0.0F) {
    color = kHair;
    return true;
  }
  // From the one who looks at it a person's left is to the right.
  const float v = 1.0F - 2.0F * (up + kFaceDown) / (kFaceUp + kFaceDown);
  color = head.face->at(left, v, pixel / head.radius);
  return true;
}

bool Painter::paint_poster(const Eigen::Vector3f& point, float pixel, Texture::Color& color) const {
  for (const Poster& poster : posters_) {
    const Eigen::Vector3f from = point - poster.middle.cast<float>();
    const auto cosine = static_cast<float>(std::cos(poster.yaw));
    const auto sine = static_cast<float>(std::sin(poster.yaw));
    const float half = 0.5F * static_cast<float>(poster.side);
    const float ahead = cosine * from.x() + sine * from.y();
    const float left = -sine * from.x() + cosine * from.y();
    if (std::abs(ahead) > kPosterDepth || std::abs(left) > half || std::abs(from.z()) > half)
      continue;
    color = pictures_[poster.picture].at(left / half, -from.z() / half, pixel / half);
    return true;
  }
  return false;
}

void Painter::shade(const Clothes::Color& color, const Gains& gains, Dress::Shades& shades) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double brightest = gains[k] * imaging::to_linear(color[k]) / (Dress::kShades - 1);
    for (std::size_t i = 0; i < shades.size(); ++i)
      shades[i][k] = imaging::to_srgb(brightest * static_cast<double>(i));
  }
}

void Painter::dress(std::span<const Body> bodies, std::span<const Gains> gains) {
  dresses_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Dress& dress = dresses_[i];
    dress.worn = bodies[i].clothes.has_value();
    if (!dress.worn) continue;
    make_limbs(bodies[i], limbs_);
    dress.waist = waist_of(bodies[i], limbs_);
    const Gains light = i < gains.size() ? gains[i] : Gains{1.0, 1.0, 1.0};
    shade(bodies[i].clothes->upper, light, dress.upper);
    shade(bodies[i].clothes->legs, light, dress.legs);
  }
}

void Painter::paint_clothes(const Dress& dress, const Eigen::Vector3f& point, float cosine,
                            std::uint8_t* rgb) {
  if (!dress.worn) return;
  const bool upper = dress.waist.up.dot(point - dress.waist.middle) > 0.0F;
  const float light = kAmbient + (1.0F - kAmbient) * std::clamp(cosine, 0.0F, 1.0F);
  const auto shade = static_cast<std::size_t>(light * (Dress::kShades - 1) + 0.5F);
  std::ranges::copy((upper ? dress.upper : dress.legs)[shade], rgb);
}

void Painter::paint(const Hits& hits, const Lens& lens, const geometry::Pose3& world_T_camera,
                    std::span<const Body> bodies, std::span<const Gains> gains,
                    std::vector<std::uint8_t>& rgb) {
  rendering::paint(hits, rgb);
  find_heads(bodies);
  dress(bodies, gains);
  const Eigen::Matrix3f turn = world_T_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_T_camera.translation.cast<float>();
  const auto per_pixel = static_cast<float>(1.0 / lens.fx);
  for (int row = 0; row < hits.height; ++row) {
    const auto down = static_cast<float>((row - lens.cy) / lens.fy);
    for (int column = 0; column < hits.width; ++column) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(hits.width) +
                     static_cast<std::size_t>(column);
      const float depth = hits.depth[i];
      const int body = hits.body[i];
      if (depth <= 0.0F || (body < 0 && posters_.empty())) continue;
      if (body >= 0 && static_cast<std::size_t>(body) >= heads_.size()) continue;
      const auto right = static_cast<float>(column - lens.cx) * per_pixel;
      const Eigen::Vector3f point = origin + turn * (depth * Eigen::Vector3f(1.0F, -right, -down));
      Texture::Color color;
      const bool painted = body >= 0 ? paint_head(heads_[static_cast<std::size_t>(body)], point,
                                                  depth * per_pixel, color)
                                     : paint_poster(point, depth * per_pixel, color);
      if (!painted && body >= 0)
        paint_clothes(dresses_[static_cast<std::size_t>(body)], point, hits.cosine[i], &rgb[3 * i]);
      if (!painted) continue;
      const float light = 0.7F + 0.3F * hits.cosine[i];
      for (std::size_t k = 0; k < 3; ++k)
        rgb[3 * i + k] = static_cast<std::uint8_t>(std::clamp(light * color[k], 0.0F, 255.0F));
    }
  }
}

}  // namespace usher::rendering
