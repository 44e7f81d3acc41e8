// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/base_side.h"

#include <algorithm>
#include <utility>

#include "renderfarm/render/sampler.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Number of steps from a seen triangle to neighbours for which light is also computed finely, because visitors see
/// more than the sampled eyes.
constexpr int kRings = 2;

void mark_seen(const render::SurfaceMesh& mesh, const std::vector<SeenPlace>& places, BaseSide* side) {
  side->seen.assign(side->points.size(), Seen::kNo);
  for (std::size_t t = 0; t < places.size(); ++t) {
    if (!places[t].is_seen()) continue;
    side->triangles.push_back({static_cast<std::uint32_t>(t), places[t].distance, places[t].weights()});
    if (side->per_triangle) {
      side->seen[t] = Seen::kYes;
    } else {
      for (const std::uint32_t vertex : mesh.triangles[t]) side->seen[vertex] = Seen::kYes;
    }
  }
  if (side->per_triangle) return;
  for (int ring = 0; ring < kRings; ++ring) {
    const std::vector<Seen> before = side->seen;
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
      const std::array<std::uint32_t, 3>& corners = mesh.triangles[t];
      if (std::ranges::all_of(corners, [&](std::uint32_t vertex) { return before[vertex] == Seen::kNo; })) continue;
      for (const std::uint32_t vertex : corners) side->seen[vertex] = std::max(side->seen[vertex], Seen::kBeside);
    }
  }
}

/// Sorts `numbers` along a Z-order curve. `place` returns the position that belongs to a number.
template <typename Number, typename Place>
void sort_along_curve(std::vector<Number>* numbers, const Place& place) {
  Eigen::AlignedBox3f box;
  for (const Number& number : *numbers) box.extend(place(number));
  std::vector<std::pair<std::uint32_t, std::size_t>> keys;
  keys.reserve(numbers->size());
  for (std::size_t i = 0; i < numbers->size(); ++i) keys.emplace_back(curve_key(box, place((*numbers)[i])), i);
  std::ranges::sort(keys);
  std::vector<Number> sorted;
  sorted.reserve(numbers->size());
  for (const auto& [key, i] : keys) sorted.push_back((*numbers)[i]);
  *numbers = std::move(sorted);
}

}  // namespace

std::uint32_t curve_key(const Eigen::AlignedBox3f& box, const Vec3& point) {
  constexpr int kBits = 10;
  const Vec3 size = box.sizes();
  std::uint32_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float part = size[axis] > 0.0f ? (point[axis] - box.min()[axis]) / size[axis] : 0.0f;
    const auto step =
        static_cast<std::uint32_t>(part > 0.0f ? std::min(part, 0.999f) * static_cast<float>(1 << kBits) : 0.0f);
    for (int bit = 0; bit < kBits; ++bit) key |= ((step >> bit) & 1u) << (3 * bit + axis);
  }
  return key;
}

std::vector<BaseSide> base_sides(const render::TraceScene& scene, const VisibleTriangles& visible, std::uint64_t seed) {
  std::vector<BaseSide> sides;
  for (std::size_t i = 0; i < scene.placements.size(); ++i) {
    const render::Placement& placement = scene.placements[i];
    const auto own_seed =
        render::mix_bits(static_cast<std::uint32_t>(seed) + 0x9e3779b9u * static_cast<std::uint32_t>(i + 1));
    const std::array<std::vector<SeenPlace>, 2>& places = visible.places[i];
    for (const bool back : {false, true}) {
      const bool is_wanted = back ? !places[1].empty() : (!places[0].empty() || places[1].empty());
      if (!is_wanted) continue;
      BaseSide side;
      side.placement = i;
      side.back = back;
      side.per_triangle = placement.mesh->normals == nullptr;
      side.points = base_points(placement, own_seed);
      if (back) {
        for (LightPoint& point : side.points) point = other_side(point);
      }
      side.light.resize(side.points.size());
      mark_seen(*placement.mesh, places[back ? 1 : 0], &side);
      for (std::size_t p = 0; p < side.points.size(); ++p) {
        if (side.points[p].exists()) side.order.push_back(static_cast<std::uint32_t>(p));
      }
      sort_along_curve(&side.order, [&](std::uint32_t p) { return side.points[p].position; });
      sort_along_curve(&side.triangles,
                       [&](const SeenTriangle& seen) { return corners_of(placement, seen.triangle)[0]; });
      sides.push_back(std::move(side));
    }
  }
  return sides;
}

void find_lamp_ranges(const render::SurfaceMesh& mesh, BaseSide* side) {
  side->lamp_ranges.clear();
  if (side->per_triangle) return;
  const std::size_t count = side->points.size();
  std::vector<float> light(count);
  for (std::size_t i = 0; i < count; ++i) light[i] = render::luminance(side->light[i].lamps.light);
  std::vector<float> lowest = light;
  std::vector<float> highest = light;
  for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
    for (const std::uint32_t a : mesh.triangles[t]) {
      for (const std::uint32_t b : mesh.triangles[t]) {
        if (side->seen[b] != Seen::kYes || !side->points[b].exists()) continue;
        lowest[a] = std::min(lowest[a], light[b]);
        highest[a] = std::max(highest[a], light[b]);
      }
    }
  }
  side->lamp_ranges.resize(count);
  for (std::size_t i = 0; i < count; ++i) side->lamp_ranges[i] = highest[i] - lowest[i];
}

}  // namespace cyclorama::light_baking
