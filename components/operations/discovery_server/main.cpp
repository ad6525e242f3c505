#include "runtime/dds/discovery_server.hpp"

int main(int argc, char** argv) { return usher::runtime::discovery_server_main(argc, argv); }
