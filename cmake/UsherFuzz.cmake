# usher_fuzz(NAME SOURCES fuzz.cpp parser.cpp ... DEPENDS lib ...)
# A libFuzzer target for a parser of outside bytes; needs clang and -DUSHER_FUZZ=ON. The parsers' sources are named, so
# that they are compiled with the fuzzer's instrumentation. Run: <build>/fuzz/fuzz-NAME [corpus folder]
option(USHER_FUZZ "Build the libFuzzer targets (clang only)" OFF)

function(usher_fuzz NAME)
  if(NOT USHER_FUZZ)
    return()
  endif()
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "USHER_FUZZ needs clang, found ${CMAKE_CXX_COMPILER_ID}")
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(fuzz-${NAME} ${ARG_SOURCES})
  set_target_properties(fuzz-${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
  target_include_directories(fuzz-${NAME} PRIVATE ${PROJECT_SOURCE_DIR}/components)
  target_link_libraries(fuzz-${NAME} PRIVATE ${ARG_DEPENDS} usher_warnings)
  target_compile_options(fuzz-${NAME} PRIVATE -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all
                         -Wno-unknown-warning-option)  # some of usher_warnings are for gcc
  target_link_options(fuzz-${NAME} PRIVATE -fsanitize=fuzzer,address,undefined)
endfunction()
