#pragma once

#include <string>
#include <vector>

#include "simulation/rendering/core/texture.hpp"

namespace usher::rendering {

/// The pictures in a folder as faces, by their names; each fills its picture as drawn_face() says.
/// Files that are no png, jpg or pgm are passed over; the error names the folder or the file.
Result<std::vector<Texture>> load_faces(const std::string& folder);

}  // namespace usher::rendering
