#include <string_view>

#include "interaction/tablet/shell/component.hpp"
#include "interaction/tablet/window/application.hpp"
#include "runtime/dds/component_main.hpp"

namespace {

/// What only tells something needs no window.
bool only_tells(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--contract" || argument == "--judge" || argument == "--help" ||
        argument == "-h" || argument == "--version")
      return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace usher;
  if (only_tells(argc, argv)) {
    return runtime::component_main(runtime::component_factory<tablet::TabletComponent>("tablet"),
                                   argc, argv);
  }
  tablet::Application application(argc, argv);
  const runtime::ComponentFactory factory{
      "tablet", [&](runtime::Host& host) {
        return std::unique_ptr<runtime::Component>(
            std::make_unique<tablet::TabletComponent>(host, application.window()));
      }};
  return application.run([&] { return runtime::component_main(factory, argc, argv); });
}
