#include "operations/all_components/all_components.hpp"
#include "runtime/dds/component_main.hpp"

int main(int argc, char** argv) {
  return usher::runtime::group_main(usher::operations::all_components(), argc, argv);
}
