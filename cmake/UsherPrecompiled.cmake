# Precompiled headers: two thirds of what a shell or a test compiles are the message types, Eigen and GoogleMock. Four sets,
# so that nobody sees what he may not: shells (messages, runtime), programs around them (the same, built quickly), tests of
# shells (the same and GoogleMock), tests of cores. Cores have none. clang-tidy reads the sources without them (.ci/lint), so
# a missing include is still found.
option(USHER_PRECOMPILED "Use precompiled headers" ON)

set(USHER_STANDARD_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <functional> <limits> <map> <memory>
                           <optional> <span> <string> <string_view> <utility> <vector> <Eigen/Geometry>)
set(USHER_MESSAGE_HEADERS ${PROJECT_SOURCE_DIR}/idl/topics.hpp ${PROJECT_SOURCE_DIR}/components/runtime/api/host.hpp)

# usher_precompile(TARGET shell | program | shell_test | core_test)
function(usher_precompile TARGET KIND)
  if(USHER_PRECOMPILED AND NOT USHER_ONLY)
    target_precompile_headers(${TARGET} REUSE_FROM usher_precompiled_${KIND})
    # Of std::string in a precompiled header GCC 12 no longer knows that it is the system's (kin of GCC bug 105651).
    get_target_property(TYPE ${TARGET} TYPE)
    if(TYPE STREQUAL EXECUTABLE)  # libraries do not meet it
      target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
    endif()
  endif()
endfunction()

# Called once, before the first usher_precompile().
function(usher_precompiled_headers)
  if(NOT USHER_PRECOMPILED OR USHER_ONLY)
    return()
  endif()
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp CONTENT "")
  foreach(KIND shell program shell_test core_test)
    if(NOT BUILD_TESTING AND KIND MATCHES test)
      continue()
    endif()
    add_library(usher_precompiled_${KIND} STATIC EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/precompiled.cpp)
    target_include_directories(usher_precompiled_${KIND} PRIVATE ${PROJECT_SOURCE_DIR}/components)
    target_link_libraries(usher_precompiled_${KIND} PRIVATE Eigen3::Eigen usher_warnings)
    target_precompile_headers(usher_precompiled_${KIND} PRIVATE ${USHER_STANDARD_HEADERS})
    if(NOT KIND STREQUAL shell)
      usher_build_quickly(usher_precompiled_${KIND})
    endif()
    if(KIND MATCHES "shell|program")
      target_link_libraries(usher_precompiled_${KIND} PRIVATE usher_idl usher_runtime)
      target_precompile_headers(usher_precompiled_${KIND} PRIVATE ${USHER_MESSAGE_HEADERS})
    endif()
    if(KIND MATCHES test)
      target_link_libraries(usher_precompiled_${KIND} PRIVATE GTest::gmock)
      target_precompile_headers(usher_precompiled_${KIND} PRIVATE <gmock/gmock.h>)
    endif()
  endforeach()
endfunction()
