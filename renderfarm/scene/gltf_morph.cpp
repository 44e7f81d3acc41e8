// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_morph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderfarm/scene/mesh_repair.h"

namespace cyclorama::scene {
namespace {

using Values = std::vector<std::array<float, 3>>;

/// Adds one attribute of a morph target to `values`, if the target has that attribute.
Status add_offsets(GltfDocument* document, const GltfObject& target, const char* semantic, double weight,
                   std::size_t vertex_count, const GltfSelection& selection, GltfBudget* budget, Values* values) {
  TRY_ASSIGN(const std::optional<std::size_t> index, document->index(target, semantic, "accessors"));
  if (!index || values->empty()) return Done{};
  TRY_ASSIGN(const GltfAccessor accessor, read_accessor(document, *index, budget));
  if (accessor.width != 3 || accessor.count != vertex_count) {
    return target.damaged(semantic, fmt::format("{} elements of {} numbers for {} vertices", accessor.count,
                                                accessor.width, vertex_count));
  }
  TRY(budget->take(accessor.place, selection.size(), sizeof(Values::value_type)));
  const Values offsets = read_floats<3>(accessor, selection);
  budget->give_back(selection.size(), sizeof(Values::value_type));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double moved = double{(*values)[i][k]} + weight * double{offsets[i][k]};
      // A value that would exceed kMaxCoordinate is not changed.
      if (std::abs(moved) < kMaxCoordinate) (*values)[i][k] = static_cast<float>(moved);
    }
  }
  return Done{};
}

}  // namespace

Result<std::vector<double>> read_morph_weights(const GltfObject& mesh) {
  TRY_ASSIGN(const GltfArray array, mesh.array("weights"));
  std::vector<double> weights;
  for (std::size_t i = 0; i < array.size(); ++i) {
    TRY_ASSIGN(const double weight, array.number(i));
    weights.push_back(weight);
  }
  return weights;
}

Status apply_morphs(GltfDocument* document, const GltfObject& primitive, const std::vector<double>& weights,
                    std::size_t vertex_count, const GltfSelection& selection, GltfContext* context, Mesh* mesh) {
  TRY_ASSIGN(const GltfArray targets, primitive.array("targets"));
  if (targets.size() == 0) return Done{};
  bool moved = false;
  for (std::size_t i = 0; i < std::min(targets.size(), weights.size()); ++i) {
    if (weights[i] == 0.0) continue;
    TRY_ASSIGN(const GltfObject target, targets.object(i));
    TRY(add_offsets(document, target, "POSITION", weights[i], vertex_count, selection, &context->budget,
                    &mesh->positions));
    TRY(add_offsets(document, target, "NORMAL", weights[i], vertex_count, selection, &context->budget, &mesh->normals));
    moved = true;
  }
  context->notes.add("a shape with morph targets is shown in its rest pose", primitive.place());
  if (moved && !mesh->normals.empty()) repair_normals(mesh);
  return Done{};
}

}  // namespace cyclorama::scene
