# The build vocabulary of the project. Include paths start at components/, so an include names its place in the
# architecture ("navigation/costmap/core/layers.hpp") and tests/contract can judge it.

# Everything that a deployment, an experiment or a benchmark runs, with the contracts; no tests.
add_custom_target(usher-programs)

# usher_library(NAME SOURCES a.cpp ... DEPENDS lib ...)
# A plain library; header-only when there are no sources.
function(usher_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${NAME} STATIC ${ARG_SOURCES})
    target_include_directories(${NAME} PUBLIC ${PROJECT_SOURCE_DIR}/components)
    target_link_libraries(${NAME} PUBLIC ${ARG_DEPENDS} PRIVATE usher_warnings)
    # Qt wants position-independent code.
    if(ARG_DEPENDS MATCHES "usher_wire|_shell|usher_results|usher_all_components|usher_lockstep_run" AND NOT ARG_DEPENDS MATCHES Qt6)
      usher_precompile(${NAME} shell)
    endif()
  else()
    add_library(${NAME} INTERFACE)
    target_include_directories(${NAME} INTERFACE ${PROJECT_SOURCE_DIR}/components)
    target_link_libraries(${NAME} INTERFACE ${ARG_DEPENDS})
  endif()
endfunction()

# usher_test(<component>.<layer>.<subject> SOURCES ... DEPENDS ... [LABELS unit] [TIMEOUT 60])
# One GoogleTest program, registered with ctest under its full name.
function(usher_test NAME)
  if(NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPENDS;LABELS;ARGUMENTS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * ${USHER_SANITIZER_FACTOR}")
  string(REPLACE "." "_" TARGET test_${NAME})
  add_executable(${TARGET} ${ARG_SOURCES})
  set_target_properties(${TARGET} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${TARGET} PRIVATE ${ARG_DEPENDS} GTest::gmock_main usher_warnings)
  usher_build_quickly(${TARGET})
  if(ARG_DEPENDS MATCHES "Qt6|_window")
    # Qt wants position-independent code.
  elseif(ARG_DEPENDS MATCHES "_shell|_wire|_runtime|_lockstep|_experiment")
    usher_precompile(${TARGET} shell_test)
  else()
    usher_precompile(${TARGET} core_test)
  endif()
  target_compile_definitions(${TARGET} PRIVATE USHER_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                               USHER_BINARY_DIR="${CMAKE_BINARY_DIR}")
  add_test(NAME ${NAME} COMMAND ${TARGET} ${ARG_ARGUMENTS})
  # A tablet that nobody looks at draws into memory.
  set_tests_properties(${NAME} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT}
                       ENVIRONMENT "QT_QPA_PLATFORM=offscreen;LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/leaks.supp:print_suppressions=0")
endfunction()

# usher_benchmark(NAME SOURCES ... DEPENDS ...)
# The program behind `usher bench NAME`: Google Benchmark, installed as bin/usher-bench-NAME.
function(usher_benchmark NAME)
  if(NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(usher-bench-${NAME} ${ARG_SOURCES})
  target_link_libraries(usher-bench-${NAME} PRIVATE ${ARG_DEPENDS} benchmark::benchmark usher_warnings)
  target_include_directories(usher-bench-${NAME} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  add_dependencies(usher-programs usher-bench-${NAME})
endfunction()

# usher_component(NAME CLASS HEADER CORE ... SHELL ... [CORE_DEPENDS ...] [SHELL_DEPENDS ...]
#                 [PROGRAM main.cpp ...] [PROGRAM_DEPENDS ...])
# From the folder it is called in: usher_<name>_core, usher_<name>_shell, the program usher-<name> with a generated
# main (or PROGRAM with its PROGRAM_DEPENDS, where a device wants the main thread; the core may be left out where another component of the folder has it), its contract as a file, installation of both, and an entry in the table of all components (usher_components).
function(usher_component NAME)
  cmake_parse_arguments(ARG "" "CLASS;HEADER" "CORE;SHELL;CORE_DEPENDS;SHELL_DEPENDS;PROGRAM;PROGRAM_DEPENDS" ${ARGN})
  if(ARG_CORE)
    usher_library(usher_${NAME}_core SOURCES ${ARG_CORE} DEPENDS ${ARG_CORE_DEPENDS})
    set(CORE usher_${NAME}_core)
  endif()
  if(NOT ARG_SHELL OR NOT TARGET usher_runtime_dds)
    return()  # a build narrowed by USHER_ONLY to cores and their tests
  endif()
  usher_library(usher_${NAME}_shell SOURCES ${ARG_SHELL}
                DEPENDS ${CORE} usher_wire usher_runtime ${ARG_SHELL_DEPENDS})

  set(COMPONENT_NAME ${NAME})
  set(COMPONENT_CLASS ${ARG_CLASS})
  set(COMPONENT_HEADER ${ARG_HEADER})
  set(MAIN ${ARG_PROGRAM})
  if(NOT MAIN)
    set(MAIN ${CMAKE_CURRENT_BINARY_DIR}/main_${NAME}.cpp)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/component_main.cpp.in ${MAIN} @ONLY)
  endif()
  add_executable(usher-${NAME} ${MAIN})
  target_link_libraries(usher-${NAME} PRIVATE usher_${NAME}_shell usher_runtime_dds ${ARG_PROGRAM_DEPENDS} usher_warnings)

  set(CONTRACT ${CMAKE_BINARY_DIR}/share/usher/contracts/${NAME}.yaml)
  add_custom_command(
    TARGET usher-${NAME} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/share/usher/contracts
    COMMAND usher-${NAME} --contract > ${CONTRACT}
    BYPRODUCTS ${CONTRACT} VERBATIM)

  add_dependencies(usher-programs usher-${NAME})
  install(TARGETS usher-${NAME} DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(FILES ${CONTRACT} DESTINATION share/usher/contracts)
  set_property(GLOBAL APPEND PROPERTY USHER_COMPONENTS ${NAME})
  set_property(GLOBAL APPEND PROPERTY USHER_COMPONENT_CLASSES ${ARG_CLASS})
  set_property(GLOBAL APPEND PROPERTY USHER_COMPONENT_HEADERS ${ARG_HEADER})
endfunction()
