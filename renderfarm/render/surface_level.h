// SPDX-License-Identifier: Apache-2.0
/// How much of the reflection model a surface needs. Each level contains those before it.
#pragma once

#include <cstdint>

namespace cyclorama {

enum class SurfaceLevel : std::uint8_t {
  kMatte,    ///< Lambert's reflection alone.
  kGlossy,   ///< And a GGX lobe: glTF's metallic-roughness model with specular and ior.
  kLayered,  ///< And a clear coat, and light that goes through: thin sheets and bodies of glass.
};

}  // namespace cyclorama
