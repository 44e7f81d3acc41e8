// SPDX-License-Identifier: Apache-2.0
/// The standard wand: one sheet of stiff paper, cut out, folded and glued. Three panels with a tag each; the lids above
/// and below are cut so that they hold the side panels at their angle, whoever folds.
///
///          ╲▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔╱               seen from above, folded:
///           ╲     lid     ╱
///     ┌──────┬──────────┬──────┐                  lid
///     │ left │  middle  │ right│             ╱─────────────╲
///     └──────┴──────────┴──────┘            ╱               ╲    side panels go back by `fold_rad`
///           ╱     lid     ╲                 ▔▔▔▔▔▔▔
///          ╱▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁╲                middle panel, to the camera
#pragma once

#include "common/wand/wand.h"

namespace cyclorama {

/// Lengths on the sheet of paper.
struct FoldedCard {
  double panel_width_m = 0.090;
  double panel_height_m = 0.092;
  double tag_size_m = 0.070;
  double fold_rad = 0.4363323129985824;  ///< 25°; docs/design/tracker.md says why.

  [[nodiscard]] double lid_depth_m() const;
  /// From the middle of the lid to the end of its longer edge.
  [[nodiscard]] double lid_half_width_m() const;
  /// The same card, all lengths times `scale`.
  [[nodiscard]] FoldedCard scaled(double scale) const;
};

/// Panels from left to right, as seen from the front.
inline constexpr int kPanels = 3;
/// Cards that differ: tag36h11 has 587 tags.
inline constexpr int kStandardWands = 587 / kPanels;

/// The wand that card number `number` folds into: tags 3 number, 3 number + 1, 3 number + 2 from left to right.
/// Precondition: number is 0 to kStandardWands - 1.
[[nodiscard]] Wand standard_wand(int number, const FoldedCard& card = {});

}  // namespace cyclorama
