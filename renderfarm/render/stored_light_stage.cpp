// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/stored_light_stage.h"

#include "renderfarm/render/lights/eye_lamp.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {
namespace {

/// Number of rays by which memory is prefetched ahead; memory access is the bottleneck of this stage.
constexpr int kAhead = 16;

/// Ends paths of one batch at stored light. Thread-bound.
class StoredLightStage {
 public:
  StoredLightStage(const TraceScene& scene, const TraceView& view, PathBatch& batch)
      : scene_(scene), view_(view), light_(*view.light), batch_(batch), rays_(batch.current().rays) {}

  void run() {
    std::array<PathRay, kMaxRays>& state = batch_.current().state;
    const int count = rays_.count();
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      if (i + kAhead < count) prefetch_triangle(i + kAhead);
      if (i + kAhead / 2 < count) prefetch_light(i + kAhead / 2);
      const auto slot = static_cast<std::size_t>(i);
      if (ends(i, state[slot])) continue;
      if (kept != i) {
        rays_.move(i, kept);
        state[static_cast<std::size_t>(kept)] = state[slot];
      }
      ++kept;
    }
    rays_.shorten(kept);
  }

 private:
  /// Returns the placement that the ray hit; null if the ray hit nothing or a surface that needs more than stored
  /// light.
  [[nodiscard]] const Placement* plain_at(int i, const RTCHit& hit) const {
    if (!rays_.has_hit(i) || is_lamp(hit)) return nullptr;
    const Placement& placement = scene_.placements[top_of(hit)];
    return placement.mesh->material->plain ? &placement : nullptr;
  }
  [[nodiscard]] bool is_lamp(const RTCHit& hit) const {
    return hit.instID[0] == RTC_INVALID_GEOMETRY_ID && scene_.lamps.holds(hit.geomID);
  }

  // Inlining is forced because gcc would treat a function that only prefetches as free of effects and drop the calls.
  [[gnu::always_inline]] void prefetch_triangle(int i) const {
    const RTCHit hit = rays_.hit(i);
    const Placement* const placement = plain_at(i, hit);
    if (placement == nullptr) return;
    placement->mesh->prefetch(hit.primID);
  }
  [[gnu::always_inline]] void prefetch_light(int i) const {
    const RTCHit hit = rays_.hit(i);
    const Placement* const placement = plain_at(i, hit);
    if (placement == nullptr) return;
    for (const light::SideLight& side : light_.surfaces[top_of(hit)].sides) {
      if (side.base.empty()) continue;
      for (const std::uint32_t corner : placement->mesh->triangles[hit.primID]) {
        if (corner < side.base.size()) __builtin_prefetch(&side.base[corner]);
      }
      if (!side.grids.empty()) __builtin_prefetch(&side.grids[hit.primID]);
    }
  }

  /// Adds the stored light that the ray finds to its path and returns true; returns false if the path does not end
  /// here.
  [[nodiscard]] bool ends(int i, const PathRay& ray) {
    if (ray.only_light || ray.scatterings > view_.max_stored_scatterings || !ray.absorption.isZero(0.0f)) return false;
    const bool eye_lamp = ray.scatterings == 0 && !scene_.eye_lamp.isZero(0.0f);
    if (eye_lamp && ray.surfaces > 0) return false;  // The lamp may be hidden, as from what a mirror shows.
    const RTCHit hit = rays_.hit(i);
    const Placement* const placement = plain_at(i, hit);
    if (placement == nullptr) return false;
    const SurfaceMesh& mesh = *placement->mesh;
    TriangleHit triangle;
    triangle.find_triangle(*placement, hit.primID);
    triangle.corners = mesh.triangles[hit.primID];
    triangle.weights = barycentric_weights(hit);
    const int side = sees_front(*placement, triangle.record(), rays_.direction(i)) ? 0 : 1;
    std::optional<Vec3> stored =
        light_.lit({top_of(hit), side, hit.primID, triangle.corners, triangle.weights}, view_.lamps);
    if (!stored) return false;
    if (eye_lamp) *stored += eye_lamp_over_pi(i, triangle);
    Path& path = batch_.path[ray.path];
    const Vec3 colour = colour_at(i, ray, triangle);
    Vec3& sum = ray.scatterings == 0 ? path.direct : path.indirect;
    // Components are added one by one, because processors stall on reading a vector that was written in parts.
    for (int c = 0; c < 3; ++c) sum[c] += ray.throughput[c] * (*stored)[c] * std::clamp(colour[c], 0.0f, 1.0f);
    return true;
  }

  /// Returns the eye lamp's irradiance over pi at a hit of a camera ray.
  [[nodiscard]] Vec3 eye_lamp_over_pi(int i, const TriangleHit& triangle) const {
    const Vec3 direction = rays_.direction(i);
    const SurfacePoint point = surface_at(triangle, direction);
    const EyeLampLight lamp = eye_lamp_at(scene_.eye_lamp, view_.eye, point.position, -direction);
    return std::max(0.0f, -point.normal.dot(direction)) / kPi * lamp.irradiance;
  }

  /// Returns SurfacePoint::front, as surface_at() computes it.
  [[nodiscard]] static bool sees_front(const Placement& placement, const TriangleRecord& record,
                                       const Vec3& direction) {
    const auto& [a, b, c] = record.corners;
    const float e1[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const float e2[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const Vec3 face(e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]);
    if (placement.baked) return !(face[0] * direction[0] + face[1] * direction[1] + face[2] * direction[2] > 0.0f);
    return !((placement.normal_matrix * normalized_or(face, -direction)).dot(direction) > 0.0f);
  }

  /// Returns the reflectance of a plain surface, before it is clamped.
  [[nodiscard]] Vec3 colour_at(int i, const PathRay& ray, const TriangleHit& triangle) const {
    const SurfaceMaterial& material = *triangle.mesh->material;
    Vec3 colour = triangle.mesh->colours != nullptr ? vertex_colour(triangle) : Vec3(Vec3::Ones());
    for (int c = 0; c < 3; ++c) colour[c] *= material.source->base_colour[c];
    if (material.base_colour != nullptr) {
      const Vec3 direction = rays_.direction(i);
      const SurfacePoint point = surface_at(triangle, direction);
      const Footprint footprint{ray.cone_width + ray.cone_spread * rays_.distance(i),
                                std::abs(point.facing.dot(direction))};
      const scene::TextureUse& use = material.source->base_colour_texture;
      const float lod = lod_of(triangle, use, *material.base_colour, footprint);
      colour =
          colour.cwiseProduct(lookup(*material.base_colour, texcoord_at(triangle, use), Coding::kSrgb, lod).head<3>());
    }
    return colour;
  }

  const TraceScene& scene_;
  const TraceView& view_;
  const light::LightStore& light_;
  PathBatch& batch_;
  RayQueue<RTCRayHit16>& rays_;
};

}  // namespace

bool ends_at_stored_light(const TraceView& view) {
  return view.quality.stored_light && view.light != nullptr && !view.features;
}

void end_at_stored_light(const TraceScene& scene, const TraceView& view, PathBatch& batch) {
  StoredLightStage(scene, view, batch).run();
}

}  // namespace cyclorama::render
