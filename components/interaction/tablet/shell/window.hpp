#pragma once

#include <string>
#include <utility>
#include <vector>

#include "interaction/finger/core/tap.hpp"
#include "interaction/tablet/core/floor_plan.hpp"
#include "interaction/tablet/core/view.hpp"

namespace usher::tablet {

/// The display as a device: draws what it is given, keeps touches until they are asked for. Called
/// on the component's thread.
class Window {
 public:
  struct Touch {
    bool typed = false;  ///< into the line: `text` is all of it; else the id of a button
    std::string text;
  };
  struct Settings {
    bool full_screen = true;
    std::string pictures;  ///< folder for a picture of every screen; empty: none
  };
  virtual ~Window() = default;
  /// Why nobody can see it; empty: somebody can.
  virtual std::string hidden() const { return {}; }
  virtual void open(const Settings& settings) = 0;
  /// What was touched since the last call, oldest first.
  virtual std::vector<Touch> take_touches() = 0;
  virtual void show(const View& view) = 0;
  virtual void show_building(const FloorPlan& plan) = 0;
  virtual void show_places(const std::vector<Place>& places) = 0;
  virtual void show_route(const std::vector<geometry::Point2>& route_in_map) = 0;
  /// A finger that is no hardware's touches what is drawn: its touch comes back as any other.
  virtual void tap(const finger::Tap& tap) = 0;
};

/// No display: for tests and simulations in one thread, which inject touches.
class NullWindow : public Window {
 public:
  void open(const Settings&) override {}
  std::vector<Touch> take_touches() override { return std::exchange(touches, {}); }
  void show(const View& shown) override { view = shown; }
  void show_building(const FloorPlan& shown) override { plan = shown; }
  void show_places(const std::vector<Place>& shown) override { places = shown; }
  void show_route(const std::vector<geometry::Point2>& shown) override { route = shown; }
  void tap(const finger::Tap& tap) override { taps.push_back(tap); }

  std::vector<Touch> touches;
  View view;
  FloorPlan plan;
  std::vector<Place> places;
  std::vector<geometry::Point2> route;
  std::vector<finger::Tap> taps;
};

}  // namespace usher::tablet
