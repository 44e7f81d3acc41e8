// SPDX-License-Identifier: Apache-2.0
/// The pattern that the visitor holds: tags fixed to each other. A single flat tag is also a wand.
///
///           ▔▔▔▔▔                 seen from above: the standard wand, a card folded into three panels. Its tags are
///         ╱       ╲               not in one plane, so that a small turn moves them relative to each other (parallax).
///        ╱    z    ╲              A flat tag seen from the front has no such parallax.
///             ▲
///             └──▶ x              Tag frame: origin in the middle of all tags; x right, y down, z into the wand, as
///          ▣ camera (below)       seen from the front (frames.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama {

/// One tag on a wand.
struct WandTag {
  int id = 0;
  double size_m = 0.0;  ///< Edge of the black square.
  /// Corners of the black square in the wand's Tag frame, in the face's order (-x, -y), (+x, -y), (+x, +y), (-x, +y):
  /// clockwise from the upper left, as seen from the front.
  std::array<Eigen::Vector3d, 4> corners;
};

/// A wand has at least one tag, and each id once. A value.
struct Wand {
  std::string name;
  std::vector<WandTag> tags;

  /// Returns the id of the first tag, which identifies the wand on the wire and in the state.
  [[nodiscard]] int id() const { return tags.front().id; }
};

/// Returns a wand that is one flat tag. Precondition: size_m > 0.
[[nodiscard]] Wand flat_tag(int id, double size_m);

/// Returns the pose of the square that best fits the four corners: origin at their middle, x along the upper edge, z
/// into the tag.
[[nodiscard]] RigidTransform<frame::Tag, frame::Face> face_of(const WandTag& tag);

/// Reads wand.toml: `name` and [[tag]] tables with `id`, `size_mm` and `corners_mm`, four points. Errors: those of
/// read_file(); kBadData, with file, line and remedy, for no tag or more than 32, for a repeated id, and for corners
/// that are not a square of that size to within 3 %.
Result<Wand> read_wand(const std::filesystem::path& path);
Result<Wand> parse_wand(std::string_view text, std::string name);
/// Returns the text that parse_wand() reads, with corners to a micrometre.
[[nodiscard]] std::string wand_toml(const Wand& wand);

}  // namespace cyclorama
