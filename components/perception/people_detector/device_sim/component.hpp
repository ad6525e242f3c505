#pragma once

#include <array>
#include <vector>

#include "perception/people_detector/shell/following.hpp"

namespace usher::people_detector {

/// Stands for the people detector where no pixels are rendered: takes whom the world's fitted model
/// says that it would find, and follows them and the legs in the scan as usual.
class PeopleDetectorSimComponent final : public runtime::Component {
 public:
  explicit PeopleDetectorSimComponent(runtime::Host& host);

 private:
  using Sightings = usher_sim_msgs::msg::Sightings;
  struct Camera {
    const char* name = "";
    Source source = Source::kKinect;
    bool heard = false;
    runtime::Time last{};
    runtime::Input<Sightings> input;
  };
  void read(Camera& camera, const topics::Topic<Sightings>& topic);
  void take(Camera& camera, const Sightings& message);
  void look(Camera& camera, const Sightings& message, runtime::Time stamp,
            const geometry::Pose2& odom_T_foot);
  std::string trouble() const;

  runtime::Host& host_;
  std::uint64_t& rejected_;
  Following following_;
  std::vector<Sighting> found_;
  Camera kinect_, rear_;
};

}  // namespace usher::people_detector
