// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_node.h"

#include <optional>
#include <utility>

#include "renderfarm/scene/gltf_instancing.h"
#include "renderfarm/scene/gltf_light.h"
#include "renderfarm/scene/gltf_skin.h"
#include "renderfarm/scene/gltf_splats.h"
#include "renderfarm/scene/gltf_transform.h"

namespace cyclorama::scene {
namespace {

struct Stage {
  GltfDocument* document;
  GltfContext* context;
  GltfMeshes* meshes;
  Model* model;
  std::vector<Eigen::Affine3d> T_model_node;  ///< Used for skins; empty if the file has none.
};

Status show_copy(const Stage& stage, const std::vector<int>& meshes, const Eigen::Affine3d& T_model_mesh,
                 const std::string& place) {
  if (!T_model_mesh.matrix().allFinite()) return gltf_damaged(place, "the transform is too large");
  if (!is_invertible(T_model_mesh)) {
    stage.context->notes.add("a node is scaled to nothing: not shown", place);
    return Done{};
  }
  TRY(stage.context->budget.take(place, meshes.size(), sizeof(Instance)));
  for (const int mesh : meshes) stage.model->instances.push_back({mesh, T_model_mesh});
  return Done{};
}

/// Shows a mesh in the rest pose of its skin. The transform of the node is ignored, because the joints place the mesh.
Status show_skinned(const Stage& stage, const GltfObject& node, std::size_t mesh) {
  TRY_ASSIGN(const std::size_t index, stage.document->required_index(node, "skin", "skins"));
  TRY_ASSIGN(const GltfObject skin, stage.document->item("skins", index));
  TRY_ASSIGN(const std::vector<Eigen::Affine3d> pose,
             read_pose(stage.document, skin, stage.T_model_node, &stage.context->budget));
  TRY_ASSIGN(const std::vector<int> meshes, stage.meshes->load_posed(mesh, pose, node.place()));
  stage.context->notes.add("a mesh with a skin is shown in its rest pose", node.place());
  return show_copy(stage, meshes, Eigen::Affine3d::Identity(), node.place());
}

Status show_mesh(const Stage& stage, const GltfObject& node, const Eigen::Affine3d& T_model_node) {
  TRY_ASSIGN(const std::optional<std::size_t> index, stage.document->index(node, "mesh", "meshes"));
  if (!index) return Done{};
  if (node.has("skin")) return show_skinned(stage, node, *index);
  TRY_ASSIGN(const std::vector<int>* const meshes, stage.meshes->load(*index));
  TRY_ASSIGN(const std::optional<GltfObject> instancing, node.extension("EXT_mesh_gpu_instancing"));
  if (!instancing) {
    TRY(add_gltf_splats(stage.document, stage.context, *index, T_model_node, stage.model));
    return show_copy(stage, *meshes, T_model_node, node.place());
  }
  TRY_ASSIGN(const std::vector<Eigen::Affine3d> copies, read_instancing(stage.document, *instancing, stage.context));
  for (const Eigen::Affine3d& T_node_mesh : copies) {
    TRY(add_gltf_splats(stage.document, stage.context, *index, T_model_node * T_node_mesh, stage.model));
    TRY(show_copy(stage, *meshes, T_model_node * T_node_mesh, node.place()));
  }
  return Done{};
}

/// Reads the pose of a node's camera. The rest of the camera is ignored, because the wall determines the field of view.
Status read_viewpoint(const Stage& stage, const GltfObject& node, const Eigen::Affine3d& T_model_node) {
  TRY_ASSIGN(const std::optional<std::size_t> camera, stage.document->index(node, "camera", "cameras"));
  if (!camera) return Done{};
  const Eigen::Vector3d direction = T_model_node.linear() * -Eigen::Vector3d::UnitZ();
  const double length = direction.norm();
  if (!T_model_node.matrix().allFinite() || !(length > 0.0)) {
    stage.context->notes.add("a camera has no direction: ignored", node.place());
    return Done{};
  }
  TRY(stage.context->budget.take(node.place(), 1, sizeof(Viewpoint)));
  stage.model->viewpoints.push_back({node.name(), T_model_node.translation(), direction / length});
  return Done{};
}

Status show_nodes(const Stage& stage, const GltfForest& forest) {
  struct Waiting {
    std::size_t node;
    Eigen::Affine3d T_model_parent;
  };
  std::vector<Waiting> waiting;
  for (auto root = forest.shown_roots.rbegin(); root != forest.shown_roots.rend(); ++root) {
    waiting.push_back({*root, Eigen::Affine3d::Identity()});
  }
  while (!waiting.empty()) {
    const Waiting next = waiting.back();
    waiting.pop_back();
    TRY_ASSIGN(const GltfObject node, stage.document->item("nodes", next.node));
    TRY_ASSIGN(const Eigen::Affine3d T_parent_node, read_node_transform(node, &stage.context->notes));
    const Eigen::Affine3d T_model_node = next.T_model_parent * T_parent_node;
    TRY(show_mesh(stage, node, T_model_node));
    TRY(read_viewpoint(stage, node, T_model_node));
    TRY_ASSIGN(std::optional<Light> light, read_node_light(*stage.document, node, T_model_node, &stage.context->notes));
    if (light) stage.model->lights.push_back(*std::move(light));
    const std::vector<std::size_t>& children = forest.children[next.node];
    for (auto child = children.rbegin(); child != children.rend(); ++child) waiting.push_back({*child, T_model_node});
  }
  return Done{};
}

/// Returns the transform of each node. All trees are included, because joints may be outside the shown scene.
Result<std::vector<Eigen::Affine3d>> transforms_of_nodes(const GltfDocument& document, const GltfForest& forest,
                                                         GltfContext* context) {
  TRY(context->budget.take("/nodes", forest.children.size(), sizeof(Eigen::Affine3d)));
  std::vector<Eigen::Affine3d> T_model_node(forest.children.size(), Eigen::Affine3d::Identity());
  std::vector<std::size_t> waiting = forest.all_roots;
  for (const std::size_t root : waiting) {
    TRY_ASSIGN(const GltfObject node, document.item("nodes", root));
    TRY_ASSIGN(T_model_node[root], read_node_transform(node, &context->notes));
  }
  while (!waiting.empty()) {
    const std::size_t parent = waiting.back();
    waiting.pop_back();
    for (const std::size_t child : forest.children[parent]) {
      TRY_ASSIGN(const GltfObject node, document.item("nodes", child));
      TRY_ASSIGN(const Eigen::Affine3d T_parent_node, read_node_transform(node, &context->notes));
      T_model_node[child] = T_model_node[parent] * T_parent_node;
      waiting.push_back(child);
    }
  }
  return T_model_node;
}

Status show_meshes_without_nodes(const Stage& stage) {
  TRY_ASSIGN(const GltfArray meshes, stage.document->root().array("meshes"));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    TRY_ASSIGN(const std::vector<int>* const loaded, stage.meshes->load(i));
    TRY(add_gltf_splats(stage.document, stage.context, i, Eigen::Affine3d::Identity(), stage.model));
    TRY(show_copy(stage, *loaded, Eigen::Affine3d::Identity(), meshes.place_of(i)));
  }
  return Done{};
}

}  // namespace

Status show_gltf_scene(GltfDocument* document, GltfContext* context, GltfMeshes* meshes, Model* ret_model) {
  Stage stage{document, context, meshes, ret_model, {}};
  TRY_ASSIGN(const GltfForest forest, read_gltf_forest(*document, &context->notes));
  if (document->root().has("skins")) {
    TRY_ASSIGN(stage.T_model_node, transforms_of_nodes(*document, forest, context));
  }
  if (forest.children.empty() && !document->root().has("scenes")) return show_meshes_without_nodes(stage);
  return show_nodes(stage, forest);
}

}  // namespace cyclorama::scene
