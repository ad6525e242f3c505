#pragma once

#include <memory>

#include "idl/topics.hpp"
#include "interaction/finger/core/tap.hpp"
#include "interaction/phrases/shell/place_titles.hpp"
#include "interaction/tablet/core/tablet.hpp"
#include "interaction/tablet/shell/window.hpp"
#include "runtime/api/host.hpp"
#include "wire/keeper.hpp"
#include "wire/repeater.hpp"

namespace usher::tablet {

/// The touch tablet: shows the dialogue and the map, sends what is touched.
class TabletComponent final : public runtime::Component {
 public:
  /// With a NullWindow.
  explicit TabletComponent(runtime::Host& host);
  /// The window must outlive the component.
  TabletComponent(runtime::Host& host, Window& window);

 private:
  TabletComponent(runtime::Host& host, std::unique_ptr<Window> own, Window* window);
  Time now() const { return host_.now().time_since_epoch(); }
  void take_screen(const usher_msgs::msg::DialogueScreen& screen);
  void take_supervisor(const usher_msgs::msg::SupervisorStatus& status);
  void take_map(const nav_msgs::msg::OccupancyGrid& map);
  void take_plan(const nav_msgs::msg::Path& path);
  void open_finger(const std::string& address);
  void take_locations(const usher_msgs::msg::Locations& locations);
  void act(const Touched& touched);
  void ask(std::uint8_t command);
  void tick();
  void show();

  runtime::Host& host_;
  std::unique_ptr<Window> own_window_;
  Window& window_;
  Tablet core_;
  phrases::PlaceTitles titles_;
  std::string language_;  ///< of the dialogue
  finger::Lines finger_;
  View shown_;
  std::uint64_t ticks_ = 0;
  std::uint64_t& rejected_;
  wire::Keeper memory_;  ///< that its Stop holds
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  /// Whoever leads a dialogue on this robot is heard.
  bool dialogue() const { return guide_.fresh() != nullptr || meeting_.fresh() != nullptr; }
  runtime::Input<usher_msgs::msg::GuideStatus> guide_;
  runtime::Input<usher_msgs::msg::MeetingStatus> meeting_;
  runtime::Input<usher_msgs::msg::SpeechStatus> speech_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<geometry_msgs::msg::PoseWithCovarianceStamped> pose_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Input<nav_msgs::msg::Path> plan_;
  runtime::Input<usher_msgs::msg::Locations> locations_;
  wire::Repeater<usher_msgs::msg::DialogueAnswer> answers_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  runtime::Timer timer_;
};

}  // namespace usher::tablet
