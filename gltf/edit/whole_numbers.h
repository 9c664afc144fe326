#pragma once

#include "gltf/edit/document.h"

namespace fascia::gltf {

/// Looks at every index, offset and count of a glTF file's core objects. Those that are written as decimals
/// but whole (`512.0`) become integers, which is all that other readers take; returns whether there were any.
/// Throws fascia::Error that says where when one is negative, has a fraction or is too large: a reader that
/// cuts it short would show other bytes than the file means.
bool make_whole_numbers(Json& root);

}  // namespace fascia::gltf
