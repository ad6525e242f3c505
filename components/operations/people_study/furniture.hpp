#pragma once

#include "foundation/random/random.hpp"
#include "simulation/rendering/core/renderer.hpp"

/// Things of a room, for pictures of people and of what is none.
namespace usher::people_study {

/// One wall, so far ahead [m].
rendering::Model empty_room(double wall = 5.5);
/// Walls at random distances, with corners, pilasters and door openings.
rendering::Model random_room(Random& random);

/// Depth along the pose's x axis, width across, all in metres.
void add_box(rendering::Model& model, const geometry::Pose2& pose, double depth, double width,
             double bottom, double top);
void add_pole(rendering::Model& model, const geometry::Point2& place, double radius, double top,
              double bottom = 0.0);
/// A chair for somebody whose hips are over the pose, the back behind.
void add_chair(rendering::Model& model, const geometry::Pose2& pose, double back);
void add_wheelchair(rendering::Model& model, const geometry::Pose2& pose);
void add_table(rendering::Model& model, const geometry::Pose2& pose, double width, double depth);
void add_railing(rendering::Model& model, const geometry::Pose2& pose, double width);
void add_lamp(rendering::Model& model, const geometry::Point2& place);
/// One thing of any kind.
void add_any(rendering::Model& model, Random& random, const geometry::Point2& place);

}  // namespace usher::people_study
