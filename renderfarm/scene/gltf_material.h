// SPDX-License-Identifier: Apache-2.0
/// Converts glTF materials and their extensions to Material.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/gltf_texture.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Reads one material. Its TextureUses contain checked indices into glTF's textures, not into Model::textures. Texture
/// coordinates beyond the second set are dropped with a note.
Result<Material> read_gltf_material(const GltfDocument& document, const GltfObject& object, GltfNotes* notes);

/// Provides the materials of primitives; each is loaded on first use. Borrows its arguments. Thread-bound.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument* document, GltfContext* context, Model* ret_model)
      : document_(document), context_(context), model_(ret_model), textures_(document, context, &ret_model->textures) {}

  /// Returns an index into Model::materials. `index` is glTF's; without one, the material is plain white.
  /// `has_texcoords` states which sets of texture coordinates the primitive has; textures that need another set are
  /// left out, so that every TextureUse in the model can be sampled.
  Result<int> load(std::optional<std::size_t> index, const std::array<bool, 2>& has_texcoords, std::string_view place);

 private:
  Result<int> load_new(std::optional<std::size_t> index, const std::array<bool, 2>& has_texcoords,
                       std::string_view place);

  GltfDocument* document_;
  GltfContext* context_;
  Model* model_;
  GltfTextures textures_;
  std::map<std::tuple<std::optional<std::size_t>, bool, bool>, int> loaded_;
};

}  // namespace cyclorama::scene
