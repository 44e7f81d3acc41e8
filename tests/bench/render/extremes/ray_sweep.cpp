// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/extremes/ray_sweep.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <random>

#include "renderfarm/render/accelerator.h"
#include "renderfarm/render/ray_queue.h"
#include "renderfarm/render/surface.h"
#include "tests/bench/render/extremes/extreme_shapes.h"

namespace cyclorama {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// A mesh in its BVH as a target for rays.
class Target {
 public:
  /// `mesh` is given in the render frame.
  static Result<std::unique_ptr<Target>> build(scene::Mesh mesh) {
    auto target = std::make_unique<Target>();
    // A second mesh keeps the render frame's origin in place.
    put(target->scene_, square(1e-3), plain_material());
    put(target->scene_, std::move(mesh), plain_material());
    TRY_ASSIGN(target->accelerator_,
               render::Accelerator::build(target->scene_, 1, nullptr, std::nullopt, &target->traced_));
    return target;
  }

  [[nodiscard]] RTCHit nearest(const render::Vec3& origin, const render::Vec3& direction, float near = 0.0f) {
    rays_->clear();
    rays_->add(origin, direction, kFar, 0);
    rays_->packet(0).ray.tnear[0] = near;
    render::trace_nearest(traced_.top, render::Coherence::kIncoherent, *rays_);
    return rays_->hit(0);
  }
  [[nodiscard]] render::SurfacePoint point(const RTCHit& hit, const render::Vec3& direction) const {
    return render::surface_at(render::triangle_at(traced_, hit), direction);
  }
  /// True if the mesh was hit, not the one that fixes the origin.
  [[nodiscard]] static bool is_hit(const RTCHit& hit) { return hit.geomID == kMesh; }

 private:
  static constexpr unsigned kMesh = 1;
  scene::Scene scene_;
  render::TraceScene traced_;
  std::unique_ptr<render::Accelerator> accelerator_;
  std::unique_ptr<render::RayQueue<RTCRayHit16>> rays_ = std::make_unique<render::RayQueue<RTCRayHit16>>();
};

render::Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const float x = normal(random), y = normal(random), z = normal(random);
  return render::normalized_or({x, y, z}, render::Vec3::UnitY());
}

render::Vec3 random_onward(const render::SurfacePoint& point, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const float u = unit(random), v = unit(random);
  return render::from_frame_of(point.facing, render::cosine_hemisphere({u, v}));
}

}  // namespace

Result<LeakCount> count_leaks(const Eigen::Vector3d& centre, int rays) {
  scene::Mesh sphere = ball(10.0, 40, false);
  for (auto& p : sphere.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      float& value = p[static_cast<std::size_t>(axis)];
      value = static_cast<float>(static_cast<double>(value) + centre[axis]);
    }
  }
  TRY_ASSIGN(const std::unique_ptr<Target> target, Target::build(std::move(sphere)));
  std::mt19937 random(9);
  LeakCount count;
  count.rays = static_cast<std::uint64_t>(rays);
  for (int i = 0; i < rays; ++i) {
    const render::Vec3 direction = random_direction(random);
    const RTCHit hit = target->nearest(centre.cast<float>(), direction);
    if (!Target::is_hit(hit)) {
      ++count.leaks;
      continue;
    }
    const render::SurfacePoint point = target->point(hit, direction);
    const RTCHit next = target->nearest(render::start_off_surface(point, point.facing), random_onward(point, random));
    if (!Target::is_hit(next)) {
      ++count.leaks;
    } else if (next.primID == hit.primID) {
      ++count.self_hits;
    }
  }
  return count;
}

Result<SelfHitCount> count_self_hits(double coordinate, int rays) {
  constexpr int kTriangles = 300;
  constexpr float kNear = 1e-4f;
  std::mt19937 random(5);
  // Spans several float steps; otherwise there would be no triangle.
  const double size = std::max(3.0, 1e-6 * coordinate);
  std::uniform_real_distribution<double> place(-3.0 * size, 3.0 * size);
  std::uniform_real_distribution<double> reach(-size, size);
  scene::Mesh mesh;
  for (std::uint32_t i = 0; i < kTriangles; ++i) {
    const Eigen::Vector3d middle(coordinate + place(random), coordinate + place(random), coordinate + place(random));
    for (int corner = 0; corner < 3; ++corner) {
      const double x = middle.x() + reach(random), y = middle.y() + reach(random), z = middle.z() + reach(random);
      mesh.positions.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const std::vector<std::array<float, 3>> corners = mesh.positions;
  TRY_ASSIGN(const std::unique_ptr<Target> target, Target::build(std::move(mesh)));
  SelfHitCount count;
  const auto away = static_cast<float>(6.0 * size);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::uniform_int_distribution<std::uint32_t> one_of(0, kTriangles - 1);
  for (int i = 0; i < rays; ++i) {
    const std::uint32_t triangle = 3 * one_of(random);
    const float a = unit(random), b = (1.0f - a) * unit(random);
    const render::Vec3 aim = a * render::to_vec3(corners[triangle]) + b * render::to_vec3(corners[triangle + 1]) +
                             (1.0f - a - b) * render::to_vec3(corners[triangle + 2]);
    const render::Vec3 direction = random_direction(random);
    const RTCHit hit = target->nearest(aim - away * direction, direction);
    if (!Target::is_hit(hit)) continue;
    const render::SurfacePoint point = target->point(hit, direction);
    const render::Vec3 onward = random_onward(point, random);
    const auto meets_itself = [&](const RTCHit& next) { return Target::is_hit(next) && next.primID == hit.primID; };
    ++count.rays;
    if (meets_itself(target->nearest(render::start_off_surface(point, point.facing), onward))) ++count.self_hits;
    if (meets_itself(target->nearest(point.position, onward, kNear))) ++count.self_hits_fixed_near;
  }
  return count;
}

}  // namespace cyclorama
