// SPDX-License-Identifier: Apache-2.0
/// What is broken in a scan: where, and what may be mended without a person who looks at it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

enum class DefectKind : std::uint8_t {
  kHole,       ///< A rim around less than a quarter of its surface's extent; larger ones are the end of a scan.
  kTurned,     ///< Triangles that face the other way than those around them.
  kInsideOut,  ///< A closed surface whose triangles face inwards, and which is inside of nothing.
  kDebris,     ///< A small part that floats in the air beside a scan.
  kNoArea,     ///< Triangles that nobody can see.
  kSliver,     ///< Triangles more than a thousand times as long as wide.
};
inline constexpr std::array kDefectKinds = {DefectKind::kHole,   DefectKind::kTurned, DefectKind::kInsideOut,
                                            DefectKind::kDebris, DefectKind::kNoArea, DefectKind::kSliver};

/// Returns a name in the plural, such as "holes".
[[nodiscard]] std::string_view name_of(DefectKind kind);
/// Returns true if repair_defects() mends it. Holes stay, because nothing is known of what is missing; slivers do no
/// harm.
[[nodiscard]] bool is_mended(DefectKind kind);

struct Defect {
  DefectKind kind = DefectKind::kHole;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();   ///< In the model's frame.
  Eigen::Vector3d facing = Eigen::Vector3d::UnitY();  ///< From where it is seen; unit length.
  double size_m = 0.0;                                ///< Diagonal.
};

struct Defects {
  struct Count {
    std::size_t places = 0;
    std::size_t triangles = 0;  ///< For holes, the edges around them.
  };
  std::array<Count, kDefectKinds.size()> counts{};
  std::vector<Defect> largest;  ///< Up to three of each kind, the largest first.
  bool is_examined = true;      ///< False if there are too many triangles.

  [[nodiscard]] const Count& count(DefectKind kind) const { return counts[static_cast<std::size_t>(kind)]; }
};

/// Examines each mesh where it is placed first; meshes that touch are one surface. `model` is in metres. Takes about
/// two seconds for each million triangles. Reentrant.
[[nodiscard]] Defects find_defects(const Model& model);

/// Turns turned triangles and surfaces that are inside out, and removes debris and triangles without an area. Returns
/// what it did, one note each. Reentrant.
std::vector<std::string> repair_defects(Model* model);

}  // namespace cyclorama::scene
