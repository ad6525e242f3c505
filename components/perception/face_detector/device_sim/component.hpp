#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::face_detector {

/// Stands for the face detector where no pixels are rendered: tells the faces of which the world's
/// model says that it would find them.
class FaceDetectorSimComponent final : public runtime::Component {
 public:
  explicit FaceDetectorSimComponent(runtime::Host& host);

 private:
  runtime::Host& host_;
  runtime::Input<usher_msgs::msg::Faces> seen_;
  runtime::Output<usher_msgs::msg::Faces> faces_;
};

}  // namespace usher::face_detector
