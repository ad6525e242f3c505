# Compiler settings that hold for every target: C++20, warnings as errors, sanitizers, ccache, mold, and the
# output layout (programs in <build>/bin, so that a build tree runs like an installed one).
include(CTest)
include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Assertions stay on in every build: a broken contract must end the process, not the robot's good manners.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
# Eigen's own assertions cost in inner loops and guard against what our tests check.
add_compile_definitions($<$<CONFIG:Release>:EIGEN_NO_DEBUG>)
# The same bits on every machine: no fused multiply-add unless a kernel asks for it by name.
add_compile_options(-ffp-contract=off)

# Sanitizers report as well at -O1, in half the time to build.
set(CMAKE_CXX_FLAGS_SANITIZE "-O1 -g1")
set(USHER_SANITIZE "" CACHE STRING "Sanitizers, for example address,undefined")
if(USHER_SANITIZE)
  add_compile_options(-fsanitize=${USHER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${USHER_SANITIZE})
endif()
# So much longer a test may take with a sanitizer (tests/support/sanitizer.hpp).
set(USHER_SANITIZER_FACTOR 1)
if(USHER_SANITIZE MATCHES thread)
  set(USHER_SANITIZER_FACTOR 15)
elseif(USHER_SANITIZE)
  set(USHER_SANITIZER_FACTOR 6)
endif()

# For tests, experiments and the command line, which wait for what the libraries compute: a quarter less time to build.
# Two warnings of GCC 12 are false alarms at -O1 (an empty std::optional; std::string compared); the libraries keep them.
function(usher_build_quickly TARGET)
  target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-stringop-overread>)
endfunction()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # What ccache needs to keep what was compiled with a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()
find_program(MOLD mold)
if(MOLD)
  add_link_options(-fuse-ld=mold)
endif()

# Linked by our own code only, so that generated code and libraries keep their own warnings.
add_library(usher_warnings INTERFACE)
# A designated initializer leaves the other members at their defaults, by design. GCC 12 warns of overlapping copies in
# its own std::string at -O3 (GCC bug 105651).
target_compile_options(usher_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
                                                -Wno-missing-field-initializers $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
