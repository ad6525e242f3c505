#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "foundation/imaging/depth_image.hpp"
#include "foundation/result/result.hpp"

namespace usher::face_detector {

/// A rectangle in an image [pixels]; rectangles around faces are square.
struct Box {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;

  double column() const { return left + 0.5 * width; }  ///< of its middle
  double row() const { return top + 0.5 * height; }     ///< of its middle
};

/// How far away a face of some size in the image is (meeting report III-B-4, figure 3): quadratic
/// in the size, 1 / depth = a + b size + c size^2. The inverse depth, because that is what a
/// pinhole camera makes the size proportional to: then the quadratic term only has to carry what
/// the cascade and the lens add.
struct SizeModel {
  double a = 0.0;                     ///< [1/m]
  double b = 1.0 / 92.0;              ///< [1/(m pixels)] a face of 0.16 m, Kinect v1
  double c = 0.0;                     ///< [1/(m pixels^2)]
  double least = 16.0, most = 400.0;  ///< [pixels] sizes that it holds for

  bool holds(double size) const { return size >= least && size <= most; }
  /// [m] for a size that it holds for.
  double depth(double size) const { return 1.0 / (a + size * (b + size * c)); }
};

/// Whether larger is nearer, at a positive distance, over all sizes that it holds for; the error
/// says where not.
Status check(const SizeModel& model);

/// The report's pair of models: one for the middle of the image, one for both sides, where lenses
/// show faces in another size.
struct DepthModel {
  SizeModel center, side;
  double middle = 0.4;  ///< {0..1} share of the image's width that the center model is for

  bool is_center(double column, int image_width) const;
  const SizeModel& at(double column, int image_width) const {
    return is_center(column, image_width) ? center : side;
  }
};

/// What a face must agree with (algorithm 6).
struct Plausibility {
  double near = 0.3;        ///< [m] no face is looked for nearer
  double far = 3.5;         ///< [m] nor farther
  double tolerance = 0.15;  ///< of the depth that the size lets expect
  double middle = 0.2;      ///< side of the box' middle that is measured, of the box' side
  double measured = 0.25;   ///< {0..1} share of it that must have a depth at all
  /// [m] by which a head stands before what is seen to its left and right, both added: a wall, a
  /// poster on it and its corner do not. Ours, not in algorithm 6; 0 takes anything.
  double relief = 0.06;
  /// {0..1} share of the middle half of a face that lies within 0.15 m of its depth: a shoulder
  /// before a picture on the wall is less than half of one. Ours too; 0 takes anything.
  double whole = 0.6;
};

/// Median depth [m] of the middle of a box, of an even number the lower one; nothing where too few
/// pixels have one or the middle lies outside. `scratch` keeps its memory.
std::optional<double> middle_depth(const imaging::DepthImage& depth, const Box& box,
                                   const Plausibility& rules, std::vector<std::uint16_t>& scratch);

/// Share of the middle half of a box that lies within 0.15 m of a depth [m].
double share_at(const imaging::DepthImage& depth, const Box& box, double at);

/// Algorithm 6 without the model of a size: `far`, then tolerance around what the size says.
bool plausible(const Box& box, double depth, int image_width, const DepthModel& model,
               const Plausibility& rules);

/// A face as it was seen: side of its rectangle and measured depth.
struct FaceSample {
  double size = 0.0;   ///< [pixels]
  double depth = 0.0;  ///< [m]
};

struct FittedModel {
  SizeModel model;
  std::vector<bool> used;  ///< of the samples; the others are no faces, or lie off the curve
  double residual = 0.0;   ///< root mean square of the relative error of the depth, of those used
  double worst = 0.0;      ///< the largest of them
};

/// The quadratic through samples of people who step back from the camera, false detections among
/// them left out. Refused with the reason: fewer than 30 samples, distances that span less than a
/// factor of 2.5, more than a third of the samples off the curve, errors of more than 8 %, a curve
/// on which larger is not nearer.
Result<FittedModel> fit_size_model(std::span<const FaceSample> samples);

}  // namespace usher::face_detector
