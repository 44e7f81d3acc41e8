// SPDX-License-Identifier: Apache-2.0
/// Complexity of the reflection model that a surface needs. Each level contains those before it.
#pragma once

#include <cstdint>

namespace cyclorama::render {

enum class SurfaceLevel : std::uint8_t {
  kMatte,    ///< Lambertian reflection only.
  kGlossy,   ///< Adds a GGX lobe: glTF's metallic-roughness model with specular and ior.
  kLayered,  ///< Adds a clear coat and transmission: thin sheets and bodies of glass.
};

}  // namespace cyclorama::render
