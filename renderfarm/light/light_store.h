// SPDX-License-Identifier: Apache-2.0
/// Precomputed light on the surfaces of a scene, so that a picture needs camera rays only.
///
/// A sample is the irradiance at a point of a surface, divided by pi: the radiance that a white matte surface would
/// reflect there. It contains all light that reaches the point, directly or after bounces, but not the colour of the
/// surface, so textures keep their full resolution. There are two kinds of samples:
///
///   base     at the vertices of a mesh with normals; otherwise one in the middle of each triangle
///   grids    at the corners of n x n parts of a triangle on which light varies more than between its vertices
///
///                 2                   row 2   o
///                / \                         / \       a grid of n = 2: six samples, row by row,
///               /   \                row 1  o - o      three of them at the triangle's corners
///              0 --- 1                     / \ / \                                                  .
///                                    row 0 o - o - o
///
/// The two sides of a surface have separate samples, and so do the instances of a mesh. Source: Yuksel, Keyser and
/// House, "Mesh Colors", ACM TOG 29(2), 2010.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "renderfarm/light/error_code.h"
#include "renderfarm/light/light_check.h"
#include "renderfarm/light/rgb9e5.h"
#include "renderfarm/scene/lamp_groups.h"

namespace cyclorama::light {

/// Marks a sample without a value, for which paths are traced instead. No encoded sample has these bits.
inline constexpr std::uint32_t kNoSample = 0xffffffffu;

/// A code for the samples of a triangle.
struct TriangleGrid {
  static constexpr std::uint32_t kBase = 0;      ///< The triangle uses the base samples.
  static constexpr std::uint32_t kTraced = ~0u;  ///< The triangle has no samples: paths are traced.
  static constexpr int kMaxParts = 256;          ///< Maximum parts along an edge; a power of two.
  static constexpr std::uint32_t kMaxOffset = 1u << 28;

  /// Returns the code of a grid of `parts` x `parts` whose samples begin at `offset`. Precondition: `parts` is a power
  /// of two and at most kMaxParts, and `offset` is below kMaxOffset.
  [[nodiscard]] static constexpr std::uint32_t code(int parts, std::uint32_t offset) {
    return (static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(parts)) + 1) << 28) | offset;
  }
  [[nodiscard]] static constexpr int parts(std::uint32_t code) { return 1 << ((code >> 28) - 1); }
  [[nodiscard]] static constexpr std::uint32_t offset(std::uint32_t code) { return code & (kMaxOffset - 1); }
  [[nodiscard]] static constexpr int samples(int parts) { return (parts + 1) * (parts + 2) / 2; }
  /// Returns the index of the sample at column `i` (towards corner 1) of row `j` (towards corner 2).
  [[nodiscard]] static constexpr int index(int parts, int i, int j) { return j * (parts + 1) - j * (j - 1) / 2 + i; }
};
static_assert(TriangleGrid::samples(2) == 6 && TriangleGrid::index(2, 0, 2) == 5);

/// Light on one side of a placed mesh; empty if no visitor sees that side.
struct SideLight {
  std::vector<std::uint32_t> base;   ///< Samples as RGB9E5 in the store's unit, or kNoSample.
  std::vector<std::uint32_t> grids;  ///< One TriangleGrid code per triangle; empty if all triangles use base samples.
  /// Mean directions of the light at the base samples, in the render frame (mean_direction.h); empty unless the
  /// material has a normal map.
  std::vector<std::uint32_t> directions;
  std::vector<std::uint32_t> samples;  ///< Samples of all grids, encoded like `base`.
  /// Standard errors of the luminance of `base` and `samples` (error_code.h).
  std::vector<std::uint8_t> base_errors;
  std::vector<std::uint8_t> sample_errors;
};

/// Size of a sample and its error.
inline constexpr std::size_t kSampleBytes = sizeof(std::uint32_t) + sizeof(std::uint8_t);

/// Light on both sides of one placement of a mesh.
struct SurfaceLight {
  bool base_per_triangle = false;  ///< True if there is one base sample per triangle; otherwise one per vertex.
  std::array<SideLight, 2> sides;  ///< Front and back, by the triangles' winding.
};

/// Identifies everything that light depends on: geometry, materials and lamps. See scene_key.h.
struct SceneKey {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const SceneKey&, const SceneKey&) = default;
};

/// A point of a surface.
struct LightPlace {
  std::size_t placement = 0;
  int side = 0;  ///< 0: front, 1: back.
  std::uint32_t primitive = 0;
  std::array<std::uint32_t, 3> vertices{};            ///< Indices of the triangle's vertices.
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< Barycentric.
};

/// The light of a whole scene. A value, immutable once in use; reading is thread-safe.
struct LightStore {
  SceneKey scene;
  std::string settings;  ///< Settings with which the light was computed, as one line for people.
  float unit = 1.0f;     ///< Radiance that a sample of 1 stands for.
  LightCheck check;      ///< Errors from held-out eyes.
  std::vector<SurfaceLight>
      surfaces;  ///< One per placement, in the order of the scene's instances that have triangles.
  /// The light of each named group of lamps, in the scene's order; `surfaces` then have that of everything else. Of a
  /// group's store, only `unit` and `surfaces` are set.
  std::vector<LightStore> groups;

  /// Returns the light at a point, without that of `groups`; nothing if paths must be traced there.
  [[nodiscard, gnu::always_inline]] std::optional<Eigen::Vector3f> at(const LightPlace& place) const {
    const SurfaceLight& surface = surfaces[place.placement];
    const SideLight& light = surface.sides[static_cast<std::size_t>(place.side)];
    if (light.base.empty()) return std::nullopt;
    const std::uint32_t grid = light.grids.empty() ? TriangleGrid::kBase : light.grids[place.primitive];
    if (grid != TriangleGrid::kBase) return in_grid(light, grid, place.weights);
    if (surface.base_per_triangle) return mixed<1>({light.base[place.primitive]}, {1.0f});
    return mixed<3>({light.base[place.vertices[0]], light.base[place.vertices[1]], light.base[place.vertices[2]]},
                    {place.weights[0], place.weights[1], place.weights[2]});
  }

  /// Returns the light at a point with the groups at their levels; nothing if paths must be traced there.
  /// `share(store)` is a factor on the light of this store and of each group.
  template <typename Share>
  [[nodiscard, gnu::always_inline]] std::optional<Eigen::Vector3f> lit(const LightPlace& place,
                                                                       const scene::LampLevels& levels,
                                                                       Share share) const {
    std::optional<Eigen::Vector3f> sum = at(place);
    if (!sum) return std::nullopt;
    *sum *= share(*this);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const float level = levels[i + 1];
      if (level == 0.0f) continue;
      const std::optional<Eigen::Vector3f> light = groups[i].at(place);
      if (!light) return std::nullopt;
      *sum += level * share(groups[i]) * *light;
    }
    return sum;
  }
  [[nodiscard, gnu::always_inline]] std::optional<Eigen::Vector3f> lit(const LightPlace& place,
                                                                       const scene::LampLevels& levels) const {
    if (groups.empty()) return at(place);
    return lit(place, levels, [](const LightStore&) { return 1.0f; });
  }

  /// Returns the mean direction of the light at a point, without that of `groups`; zero if it is unknown.
  [[nodiscard]] Eigen::Vector3f direction_at(const LightPlace& place) const;

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t sample_count() const;
  /// Returns percentiles of the samples' standard errors, relative to their luminance. Omits dark samples, which are
  /// below a tenth of the mean.
  [[nodiscard]] Percentiles relative_errors() const;

 private:
  template <std::size_t kCount>
  [[nodiscard, gnu::always_inline]] std::optional<Eigen::Vector3f> mixed(
      const std::array<std::uint32_t, kCount>& codes, const std::array<float, kCount>& weights) const {
    // Uses single floats, because vectors of three would be written and read in parts of different sizes, which stalls
    // processors.
    float red = 0.0f;
    float green = 0.0f;
    float blue = 0.0f;
    for (std::size_t i = 0; i < kCount; ++i) {
      if (codes[i] == kNoSample) return std::nullopt;
      const float weight = step_of_rgb9e5(codes[i]) * weights[i];
      red += static_cast<float>(codes[i] & 511u) * weight;
      green += static_cast<float>((codes[i] >> 9) & 511u) * weight;
      blue += static_cast<float>((codes[i] >> 18) & 511u) * weight;
    }
    return Eigen::Vector3f(red * unit, green * unit, blue * unit);
  }
  [[nodiscard]] std::optional<Eigen::Vector3f> in_grid(const SideLight& light, std::uint32_t grid,
                                                       const Eigen::Vector3f& weights) const;
};

/// Describes the known errors of the store in one or two sentences for people.
[[nodiscard]] std::string description_of(const LightStore& store);

}  // namespace cyclorama::light
