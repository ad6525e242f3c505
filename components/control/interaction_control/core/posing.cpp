#include "control/interaction_control/core/posing.hpp"

namespace usher::interaction_control {

const Zone* Posing::chosen(Occasion occasion) const {
  const Zone* rest = zones_.find(parameters_.rest);
  switch (occasion) {
    case Occasion::kInteract:
      if (zone_ != nullptr) return zone_;
      return rest != nullptr && alone_ >= parameters_.rest_after ? rest : pose_;
    case Occasion::kDrive:
      return rest != nullptr ? rest : pose_;
    case Occasion::kHold:
      break;
  }
  return pose_;
}

void Posing::step(const Moment& moment, double seconds) {
  person_ = companion_.choose(moment.people, zones_);
  const bool interacts = moment.occasion == Occasion::kInteract;
  zone_ = zones_.update(interacts && person_ ? std::optional(person_->place) : std::nullopt);
  alone_ = zone_ != nullptr ? 0.0 : alone_ + seconds;
  pose_ = chosen(moment.occasion);

  if (moment.torso && !known_) motion_.start_at(*moment.torso);
  known_ = moment.torso.has_value();
  // Who drives does not drive off leaning, whoever is heard meanwhile.
  const bool drives = moment.occasion == Occasion::kDrive;
  motion_.hold((moment.listens && !drives) || moment.occasion == Occasion::kHold);
  if (known_ && pose_ != nullptr) motion_.go_to(pose_->pose);
  if (known_) motion_.step(seconds);
  if (pose_ != nullptr)
    eyes_.step(pose_->left_eye, pose_->right_eye, pose_->voice ? moment.level : 0.0, seconds);
}

}  // namespace usher::interaction_control
