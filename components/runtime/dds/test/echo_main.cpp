// A component program as usher_component() makes them; with --group the program of a manifest's
// group.
#include <string_view>

#include "echo_component.hpp"
#include "runtime/dds/component_main.hpp"

int main(int argc, char** argv) {
  using namespace usher::runtime;
  const ComponentFactory factory = component_factory<test::EchoComponent>("echo");
  if (argc > 1 && std::string_view(argv[1]) == "--group") {
    argv[1] = argv[0];
    return group_main(std::span(&factory, 1), argc - 1, argv + 1);
  }
  return component_main(factory, argc, argv);
}
