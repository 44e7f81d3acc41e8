// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/alpha_filter.h"

#include <algorithm>

#include "renderfarm/render/sampler.h"
#include "renderfarm/render/surface.h"

namespace cyclorama::render {
namespace {

/// Returns true if the ray of `lane` passes through at this hit. The ray's id is the index of the sample; each surface
/// draws its own random number from the sample's sequence, so the samples of a pixel stay well distributed in whatever
/// order the traversal meets surfaces.
bool lets_through(const SurfaceMesh& mesh, const RTCFilterFunctionNArguments& arguments, unsigned lane) {
  TriangleHit hit;
  hit.mesh = &mesh;
  const unsigned triangle = RTCHitN_primID(arguments.hit, arguments.N, lane);
  const float u = RTCHitN_u(arguments.hit, arguments.N, lane);
  const float v = RTCHitN_v(arguments.hit, arguments.N, lane);
  hit.corners = mesh.triangles[triangle];
  hit.weights = Vec3(std::max(0.0f, 1.0f - u - v), u, v);
  const float alpha = alpha_at(hit);
  if (mesh.material->cut_out) return alpha < mesh.material->source->alpha_cutoff;
  const std::uint32_t sample = RTCRayN_id(arguments.ray, arguments.N, lane);
  const std::uint32_t instance = RTCHitN_instID(arguments.hit, arguments.N, lane, 0);
  const std::uint32_t geometry = RTCHitN_geomID(arguments.hit, arguments.N, lane);
  return alpha <= sobol_value(sample, mix_bits(triangle ^ mix_bits(geometry ^ mix_bits(instance))), 0);
}

}  // namespace

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto& mesh = *static_cast<const SurfaceMesh*>(arguments->geometryUserPtr);
  for (unsigned lane = 0; lane < arguments->N; ++lane) {
    if (arguments->valid[lane] == -1 && lets_through(mesh, *arguments, lane)) arguments->valid[lane] = 0;
  }
}

void pass_all_filter(const RTCFilterFunctionNArguments* arguments) { std::fill_n(arguments->valid, arguments->N, 0); }

}  // namespace cyclorama::render
