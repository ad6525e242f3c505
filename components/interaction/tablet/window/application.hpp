#pragma once

#include <functional>
#include <memory>

#include "interaction/tablet/shell/window.hpp"

namespace usher::tablet {

class ScreenModel;

/// Qt on the main thread, the component on another one.
class Application {
 public:
  /// Without a display (no X11 or Wayland session, no platform chosen) it draws into memory,
  /// and its window says so.
  Application(int& argc, char** argv);
  ~Application();

  /// For the component: everything it shows is handed over to this thread.
  Window& window();
  /// Runs `component` on a thread of its own until it ends, the window on this one. Closing the
  /// window asks the program to stop, as SIGTERM does. Exit code of the component.
  int run(const std::function<int()>& component);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace usher::tablet
