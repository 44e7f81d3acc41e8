// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace cyclorama::scene {
namespace {

constexpr const char* kExtension = "KHR_lights_punctual";

Result<std::optional<GltfObject>> find_light(const GltfDocument& document, const GltfObject& node) {
  TRY_ASSIGN(const std::optional<GltfObject> reference, node.extension(kExtension));
  if (!reference) return std::optional<GltfObject>();
  TRY_ASSIGN(const std::uint64_t index, reference->required_integer("light"));
  TRY_ASSIGN(const std::optional<GltfObject> extension, document.root().extension(kExtension));
  if (!extension) return reference->damaged("light", "the file has no list of lights");
  TRY_ASSIGN(const GltfArray lights, extension->array("lights"));
  if (index >= lights.size())
    return reference->damaged("light", fmt::format("index {} of {} lights", index, lights.size()));
  TRY_ASSIGN(GltfObject light, lights.object(static_cast<std::size_t>(index)));
  return std::optional(std::move(light));
}

Status read_cone(const GltfObject& object, Light* ret_light) {
  TRY_ASSIGN(const std::optional<GltfObject> spot, object.object("spot"));
  if (!spot) return object.damaged("spot", "is missing");
  TRY_ASSIGN(const std::optional<double> inner, spot->number("innerConeAngle"));
  TRY_ASSIGN(const std::optional<double> outer, spot->number("outerConeAngle"));
  constexpr double kMaxConeRad = 1.5707963267948966;
  ret_light->outer_cone_rad = outer.value_or(ret_light->outer_cone_rad);
  ret_light->inner_cone_rad = inner.value_or(0.0);
  if (!(ret_light->outer_cone_rad > 0.0 && ret_light->outer_cone_rad <= kMaxConeRad)) {
    return spot->damaged("outerConeAngle", "an angle over 0 and up to pi/2 is needed here");
  }
  if (!(ret_light->inner_cone_rad >= 0.0 && ret_light->inner_cone_rad <= ret_light->outer_cone_rad)) {
    return spot->damaged("innerConeAngle", "an angle from 0 up to the outer one is needed here");
  }
  return Done{};
}

Status place(const Eigen::Affine3d& T_model_node, const GltfObject& object, Light* ret_light) {
  // A light shines along the -z axis of its node.
  const Eigen::Vector3d direction = T_model_node.linear() * -Eigen::Vector3d::UnitZ();
  const double length = direction.norm();
  const bool needs_direction = ret_light->kind != LightKind::kPoint;
  if (!T_model_node.matrix().allFinite() || (needs_direction && !(length > 0.0 && std::isfinite(length)))) {
    return gltf_damaged(object.place(), "the node that carries this light has no direction");
  }
  ret_light->position = T_model_node.translation();
  if (needs_direction) ret_light->direction = direction / length;
  return Done{};
}

}  // namespace

Result<std::optional<Light>> read_node_light(const GltfDocument& document, const GltfObject& node,
                                             const Eigen::Affine3d& T_model_node, GltfNotes* notes) {
  TRY_ASSIGN(const std::optional<GltfObject> object, find_light(document, node));
  if (!object) return std::optional<Light>();
  Light light;
  light.name = object->name();
  TRY_ASSIGN(const std::string kind, object->text_or("type", ""));
  if (kind == "directional") {
    light.kind = LightKind::kDirectional;
  } else if (kind == "spot") {
    light.kind = LightKind::kSpot;
    TRY(read_cone(*object, &light));
  } else if (kind != "point") {
    notes->add("a light is neither point, spot nor directional: ignored", object->place());
    return std::optional<Light>();
  }
  TRY_ASSIGN(const auto colour, object->numbers<3>("color"));
  TRY_ASSIGN(const std::optional<double> intensity, object->number("intensity"));
  TRY_ASSIGN(const std::optional<double> range, object->number("range"));
  const std::array<double, 3> rgb = colour.value_or(std::array{1.0, 1.0, 1.0});
  constexpr double kBrightest = 1e12;  // Keeps sums of lights finite in float.
  for (int i = 0; i < 3; ++i) {
    const double value = rgb[static_cast<std::size_t>(i)] * intensity.value_or(1.0);
    light.intensity[i] = static_cast<float>(std::clamp(value, 0.0, kBrightest));
  }
  light.range_m = std::max(range.value_or(0.0), 0.0);
  TRY(place(T_model_node, *object, &light));
  return std::optional(std::move(light));
}

}  // namespace cyclorama::scene
