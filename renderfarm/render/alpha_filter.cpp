// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/alpha_filter.h"

#include "renderfarm/render/sampler.h"
#include "renderfarm/render/surface.h"

namespace cyclorama {
namespace {

/// Whether the ray goes through at this hit. `seed` decides half-transparent surfaces: each by itself, and alike for
/// every order in which the traversal meets them.
bool lets_through(const SurfaceMesh& mesh, const RTCFilterFunctionNArguments& arguments) {
  TriangleHit hit;
  hit.mesh = &mesh;
  const unsigned triangle = RTCHitN_primID(arguments.hit, arguments.N, 0);
  const float u = RTCHitN_u(arguments.hit, arguments.N, 0);
  const float v = RTCHitN_v(arguments.hit, arguments.N, 0);
  hit.corners = mesh.triangles[triangle];
  hit.weights = Vec3(std::max(0.0f, 1.0f - u - v), u, v);
  const float alpha = alpha_at(hit);
  if (mesh.material->cut_out) return alpha < mesh.material->source->alpha_cutoff;
  const std::uint32_t seed = RTCRayN_id(arguments.ray, arguments.N, 0);
  const std::uint32_t instance = RTCHitN_instID(arguments.hit, arguments.N, 0, 0);
  const std::uint32_t geometry = RTCHitN_geomID(arguments.hit, arguments.N, 0);
  return alpha <= to_unit_float(mix_bits(seed ^ mix_bits(triangle ^ mix_bits(geometry ^ mix_bits(instance)))));
}

}  // namespace

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->valid[0] != -1) return;
  const auto& mesh = *static_cast<const SurfaceMesh*>(arguments->geometryUserPtr);
  if (lets_through(mesh, *arguments)) arguments->valid[0] = 0;
}

}  // namespace cyclorama
