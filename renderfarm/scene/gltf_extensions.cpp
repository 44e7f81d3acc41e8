// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/text.h"

namespace cyclorama::scene {
namespace {

constexpr std::array<std::string_view, 21> kSupported = {
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_gaussian_splatting",
    "KHR_gaussian_splatting_compression_spz_2",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",  // Approximated; gltf_specular_glossiness.cpp notes what is lost.
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",  // Without a choice of variant, the default materials are shown.
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",  // Metadata of the file.
};

template <typename List>
bool contains(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

Result<std::set<std::string, std::less<>>> check_gltf_extensions(const GltfObject& root, GltfNotes* notes) {
  std::set<std::string, std::less<>> names;
  TRY_ASSIGN(const GltfArray used, root.array("extensionsUsed"));
  for (std::size_t i = 0; i < used.size(); ++i) {
    TRY_ASSIGN(std::string name, used.text(i));
    names.insert(std::move(name));
  }
  TRY_ASSIGN(const GltfArray required, root.array("extensionsRequired"));
  for (std::size_t i = 0; i < required.size(); ++i) {
    TRY_ASSIGN(std::string name, required.text(i));
    if (!contains(kSupported, name)) {
      return Error(ErrorCode::kBadData, fmt::format("{}: {} is required and not supported; export the scene without it",
                                                    required.place_of(i), printable(name)));
    }
    names.insert(std::move(name));
  }
  for (const std::string& name : names) {
    if (!contains(kSupported, name)) notes->add(fmt::format("{} is not supported: ignored", printable(name)), "");
  }
  return names;
}

}  // namespace cyclorama::scene
