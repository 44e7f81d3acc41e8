// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_vertices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/image/colour.h"
#include "renderfarm/scene/mesh_repair.h"

namespace cyclorama::scene {
namespace {

using Float3 = std::array<float, 3>;

/// Returns true if all values are finite and small enough that their squares are finite as well.
template <std::size_t N>
bool is_usable_number(const std::array<float, N>& values) {
  bool usable = true;  // Computed without a branch, because most data is valid and this runs for every vertex.
  for (const float v : values) usable &= std::abs(v) < static_cast<float>(kMaxCoordinate);
  return usable;
}

template <std::size_t N>
bool all_usable(const std::vector<std::array<float, N>>& values) {
  return std::all_of(values.begin(), values.end(), is_usable_number<N>);
}

/// Scales a vector to unit length. Returns false and leaves the vector unchanged if it has no direction.
bool normalise(float* xyz) {
  const double length =
      std::sqrt(double{xyz[0]} * double{xyz[0]} + double{xyz[1]} * double{xyz[1]} + double{xyz[2]} * double{xyz[2]});
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  for (int i = 0; i < 3; ++i) xyz[i] = static_cast<float>(double{xyz[i]} / length);
  return true;
}

void drop_broken_triangles(const GltfAccessor& accessor, GltfContext* context, Mesh* mesh) {
  std::vector<bool> broken(mesh->positions.size());
  for (std::size_t i = 0; i < broken.size(); ++i) {
    if (is_usable_number(mesh->positions[i])) continue;
    broken[i] = true;
    mesh->positions[i] = {0.0f, 0.0f, 0.0f};
  }
  const auto is_broken = [&](const std::array<std::uint32_t, 3>& t) {
    return broken[t[0]] || broken[t[1]] || broken[t[2]];
  };
  const std::size_t dropped = std::erase_if(mesh->triangles, is_broken);
  if (dropped == 0) return;
  context->notes.add(fmt::format("{} triangles have corners that are not finite: left out", dropped), accessor.place);
}

bool is_integer_up_to_16_bits(GltfComponent component) {
  return component != GltfComponent::kU32 && component != GltfComponent::kF32;
}

bool is_unsigned_normalized(const GltfAccessor& a) {
  return a.normalized && (a.component == GltfComponent::kU8 || a.component == GltfComponent::kU16);
}

bool is_allowed(const GltfAccessor& a, GltfVertexKind kind, bool quantized) {
  const bool is_float = a.component == GltfComponent::kF32;
  const bool is_signed = a.component == GltfComponent::kI8 || a.component == GltfComponent::kI16;
  switch (kind) {
    case GltfVertexKind::kPosition:
      return a.width == 3 && (is_float || (quantized && is_integer_up_to_16_bits(a.component)));
    case GltfVertexKind::kNormal:
      return a.width == 3 && (is_float || (quantized && is_signed && a.normalized));
    case GltfVertexKind::kTangent:
      return a.width == 4 && (is_float || (quantized && is_signed && a.normalized));
    case GltfVertexKind::kTexcoord:
      return a.width == 2 &&
             (is_float || is_unsigned_normalized(a) || (quantized && is_integer_up_to_16_bits(a.component)));
    case GltfVertexKind::kColour:
      return (a.width == 3 || a.width == 4) && (is_float || is_unsigned_normalized(a));
    case GltfVertexKind::kJoints:
      return a.width == 4 && !a.normalized && (a.component == GltfComponent::kU8 || a.component == GltfComponent::kU16);
    case GltfVertexKind::kWeights:
      return a.width == 4 && (is_float || is_unsigned_normalized(a));
  }
  return false;
}

std::uint8_t alpha8(float alpha) {
  return static_cast<std::uint8_t>(std::clamp(std::isnan(alpha) ? 1.0f : alpha, 0.0f, 1.0f) * 255.0f + 0.5f);
}

/// Table of the sRGB codes of 16-bit linear light, for speed. Its codes differ from exact ones at most by rounding.
class SrgbTable {
 public:
  SrgbTable() : codes_(kSteps + 1) {
    for (std::size_t i = 0; i <= kSteps; ++i) codes_[i] = linear_to_srgb8(static_cast<float>(i) / kSteps);
  }
  [[nodiscard]] std::uint8_t operator()(float linear) const {
    if (!(linear > 0.0f)) return 0;  // Includes NaN.
    return codes_[static_cast<std::size_t>(std::min(linear, 1.0f) * kSteps + 0.5f)];
  }

 private:
  static constexpr std::size_t kSteps = 65535;
  std::vector<std::uint8_t> codes_;
};

template <std::size_t N>
void convert_colours(const std::vector<std::array<float, N>>& linear, Mesh* mesh) {
  static const SrgbTable srgb;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const std::array<float, N>& c = linear[i];
    std::uint8_t alpha = 255;
    if constexpr (N == 4) alpha = alpha8(c[3]);
    mesh->colours[i] = {srgb(c[0]), srgb(c[1]), srgb(c[2]), alpha};
  }
}

}  // namespace

Status check_vertex_format(const GltfAccessor& accessor, GltfVertexKind kind, bool quantized) {
  if (is_allowed(accessor, kind, quantized)) return Done{};
  return gltf_damaged(accessor.place, "its type is not allowed for this attribute");
}

Status read_positions(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh) {
  TRY(context->budget.take(accessor.place, selection.size(), sizeof(Float3)));
  mesh->positions = read_floats<3>(accessor, selection);
  if (!all_usable(mesh->positions)) drop_broken_triangles(accessor, context, mesh);
  return Done{};
}

bool are_positions_usable(const GltfAccessor& accessor, const GltfSelection& selection) {
  return all_usable(read_floats<3>(accessor, selection));
}

Status read_normals(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh) {
  TRY(context->budget.take(accessor.place, selection.size(), sizeof(Float3)));
  mesh->normals = read_floats<3>(accessor, selection);
  const auto is_broken = [](const Float3& n) {
    return !is_usable_number(n) || (n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f);
  };
  if (const auto count = std::count_if(mesh->normals.begin(), mesh->normals.end(), is_broken); count > 0) {
    context->notes.add(fmt::format("{} normals have no direction: taken from the surface", count), accessor.place);
  }
  repair_normals(mesh);
  return Done{};
}

Status read_tangents(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh) {
  TRY(context->budget.take(accessor.place, selection.size(), sizeof mesh->tangents[0]));
  mesh->tangents = read_floats<4>(accessor, selection);
  for (std::array<float, 4>& tangent : mesh->tangents) {
    const bool has_direction = normalise(tangent.data());
    if (!has_direction || !std::isfinite(tangent[3])) {
      context->notes.add("some tangents have no direction: all are derived from the texture coordinates",
                         accessor.place);
      mesh->tangents.clear();
      mesh->tangents.shrink_to_fit();
      break;
    }
    tangent[3] = tangent[3] < 0.0f ? -1.0f : 1.0f;
  }
  return Done{};
}

Status read_texcoords(const GltfAccessor& accessor, const GltfSelection& selection, int set, GltfContext* context,
                      Mesh* mesh) {
  auto& texcoords = mesh->texcoords[static_cast<std::size_t>(set)];
  TRY(context->budget.take(accessor.place, selection.size(), sizeof texcoords[0]));
  texcoords = read_floats<2>(accessor, selection);
  if (all_usable(texcoords)) return Done{};
  for (std::array<float, 2>& texcoord : texcoords) {
    if (!is_usable_number(texcoord)) texcoord = {0.0f, 0.0f};
  }
  context->notes.add("some texture coordinates are not finite: taken as 0", accessor.place);
  return Done{};
}

Status read_colours(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh) {
  const std::size_t work_bytes = static_cast<std::size_t>(accessor.width) * sizeof(float);
  TRY(context->budget.take(accessor.place, selection.size(), sizeof mesh->colours[0] + work_bytes));
  mesh->colours.resize(selection.size());
  if (accessor.width == 3) {
    convert_colours(read_floats<3>(accessor, selection), mesh);
  } else {
    convert_colours(read_floats<4>(accessor, selection), mesh);
  }
  context->budget.give_back(selection.size(), work_bytes);
  return Done{};
}

}  // namespace cyclorama::scene
