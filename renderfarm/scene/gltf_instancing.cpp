// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_instancing.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_transform.h"

namespace cyclorama::scene {
namespace {

/// Reads one attribute; returns an empty list if it is absent. All attributes must have the same length, which the
/// first one read stores in `count`.
template <std::size_t N>
Result<std::vector<std::array<float, N>>> read_values(GltfDocument* document, const GltfObject& attributes,
                                                      const char* name, GltfContext* context,
                                                      std::optional<std::size_t>* count) {
  TRY_ASSIGN(const std::optional<std::size_t> index, document->index(attributes, name, "accessors"));
  if (!index) return std::vector<std::array<float, N>>();
  TRY_ASSIGN(const GltfAccessor accessor, read_accessor(document, *index, &context->budget));
  const bool is_float = accessor.component == GltfComponent::kF32;
  const bool is_signed_unit =
      accessor.normalized && (accessor.component == GltfComponent::kI8 || accessor.component == GltfComponent::kI16);
  if (accessor.width != static_cast<int>(N) || !(is_float || (N == 4 && is_signed_unit))) {
    return gltf_damaged(accessor.place, fmt::format("its type is not allowed for {}", name));
  }
  if (accessor.count != count->value_or(accessor.count)) {
    return attributes.damaged(name, fmt::format("{} elements for {} instances", accessor.count, **count));
  }
  *count = accessor.count;
  TRY(context->budget.take(accessor.place, accessor.count, N * sizeof(float)));
  return read_floats<N>(accessor, GltfSelection::all(accessor.count));
}

Eigen::Vector3d to_double(const std::array<float, 3>& v) { return {double{v[0]}, double{v[1]}, double{v[2]}}; }

}  // namespace

Result<std::vector<Eigen::Affine3d>> read_instancing(GltfDocument* document, const GltfObject& extension,
                                                     GltfContext* context) {
  TRY_ASSIGN(const std::optional<GltfObject> attributes, extension.object("attributes"));
  if (!attributes) return extension.damaged("attributes", "is missing");
  std::optional<std::size_t> count;
  TRY_ASSIGN(const auto translations, read_values<3>(document, *attributes, "TRANSLATION", context, &count));
  TRY_ASSIGN(const auto rotations, read_values<4>(document, *attributes, "ROTATION", context, &count));
  TRY_ASSIGN(const auto scales, read_values<3>(document, *attributes, "SCALE", context, &count));
  if (!count) {
    return extension.damaged("attributes", "TRANSLATION, ROTATION or SCALE is needed here");
  }
  TRY(context->budget.take(extension.place(), *count, sizeof(Eigen::Affine3d)));
  std::vector<Eigen::Affine3d> copies;
  copies.reserve(*count);
  for (std::size_t i = 0; i < *count; ++i) {
    const Eigen::Vector3d t = translations.empty() ? Eigen::Vector3d::Zero() : to_double(translations[i]);
    const Eigen::Vector3d s = scales.empty() ? Eigen::Vector3d::Ones() : to_double(scales[i]);
    Eigen::Vector4d r(0.0, 0.0, 0.0, 1.0);
    if (!rotations.empty()) {
      const std::array<float, 4>& q = rotations[i];
      r = {double{q[0]}, double{q[1]}, double{q[2]}, double{q[3]}};
    }
    const std::optional<Eigen::Affine3d> copy = compose_transform(t, r, s);
    if (!copy) return gltf_damaged(extension.place(), fmt::format("instance {} has no rotation", i));
    copies.push_back(*copy);
  }
  return copies;
}

}  // namespace cyclorama::scene
