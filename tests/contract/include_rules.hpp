#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace usher::contract {

/// Why a source file below components/ may not include something; empty when it may. `path` starts
/// at components/
/// ("navigation/costmap/core/costmap.cpp"), `include` is as written, with its quotes or brackets.
///
/// The rules of the house: foundation <- core <- shell -> runtime, wire; a core knows no
/// middleware, no component knows another one (base_obedience,
/// laser_scanner, serial_frame, phrases and rendering are libraries; the shells of drivers share
/// the first two's, those of control the first one's reader of parameters), only runtime/dds knows
/// Fast DDS, nobody but its own shell includes the simulated world. operations/ may use every core
/// and shell.
std::string include_breach(std::string_view path, std::string_view include);

/// What a core or foundation file may not even mention: clocks, threads, random devices, the
/// environment. Empty when the line is fine.
std::string word_breach(std::string_view path, std::string_view line);

/// The includes of a source text, with their quotes or brackets.
std::vector<std::string> includes_of(const std::string& text);

}  // namespace usher::contract
