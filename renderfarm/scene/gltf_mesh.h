// SPDX-License-Identifier: Apache-2.0
/// Converts glTF meshes: each primitive with a surface becomes one Mesh.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/gltf_material.h"
#include "renderfarm/scene/gltf_skin.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Loads each glTF mesh when a node first uses it. Borrows its arguments. Thread-bound.
class GltfMeshes {
 public:
  GltfMeshes(GltfDocument* document, GltfContext* context, Model* ret_model)
      : document_(document), context_(context), model_(ret_model), materials_(document, context, ret_model) {}

  /// Returns indices into Model::meshes, valid as long as this object. Precondition: `index` came from
  /// GltfDocument::index().
  Result<const std::vector<int>*> load(std::size_t index);
  /// Returns the meshes of `index`, moved by the pose of a skin; meshes without joints are not moved, with a note. Each
  /// call makes a copy, because two nodes rarely share a skinned mesh.
  Result<std::vector<int>> load_posed(std::size_t index, const std::vector<Eigen::Affine3d>& pose,
                                      const std::string& place);

 private:
  Result<std::optional<Mesh>> read_primitive(const GltfObject& primitive, const std::vector<double>& morph_weights,
                                             std::optional<GltfSkinning>* ret_skinning);

  GltfDocument* document_;
  GltfContext* context_;
  Model* model_;
  GltfMaterials materials_;
  std::map<std::size_t, std::vector<int>> loaded_;
  std::map<int, GltfSkinning> skinnings_;  ///< Keyed by index into Model::meshes.
};

}  // namespace cyclorama::scene
