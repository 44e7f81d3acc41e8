// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "renderfarm/scene/gltf_import.h"

namespace {

// The model must be consistent, since the ray tracer uses it without further checks.
void check(const cyclorama::scene::Model& model) {
  const auto require = [](bool condition) {
    if (!condition) std::abort();
  };
  require(!model.materials.empty());
  for (const cyclorama::scene::Mesh& mesh : model.meshes) {
    require(mesh.material >= 0 && static_cast<std::size_t>(mesh.material) < model.materials.size());
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t corner : t) require(corner < mesh.positions.size());
    }
    for (const auto& p : mesh.positions) {
      for (const float v : p) require(v - v == 0.0f);
    }
    for (const std::size_t size : {mesh.normals.size(), mesh.tangents.size(), mesh.colours.size(),
                                   mesh.texcoords[0].size(), mesh.texcoords[1].size()}) {
      require(size == 0 || size == mesh.positions.size());
    }
  }
  for (const cyclorama::scene::Instance& instance : model.instances) {
    require(instance.mesh >= 0 && static_cast<std::size_t>(instance.mesh) < model.meshes.size());
    require(instance.T_model_mesh.matrix().allFinite());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cyclorama::scene::ImportLimits limits;
  limits.memory_bytes = std::size_t{256} << 20;
  limits.texture_px = std::size_t{1} << 20;
  const auto model = cyclorama::scene::import_gltf_bytes(std::as_bytes(std::span(data, size)), std::nullopt, limits);
  if (model) check(*model);
  return 0;
}
