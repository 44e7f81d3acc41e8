// SPDX-License-Identifier: Apache-2.0
/// The standard wand: one sheet of stiff paper, cut out, folded and glued. It has three panels with a tag each; the
/// shape of the upper and lower lids fixes the angle of the side panels, however the sheet is folded.
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
  double fold_rad = 0.4363323129985824;  ///< 25°; docs/design/tracker.md gives the reason.

  [[nodiscard]] double lid_depth_m() const;
  /// Distance from the middle of the lid to the end of its longer edge.
  [[nodiscard]] double lid_half_width_m() const;
  /// Returns the same card with all lengths multiplied by `scale`.
  [[nodiscard]] FoldedCard scaled(double scale) const;
};

/// Panels from left to right, as seen from the front.
inline constexpr int kPanels = 3;
/// Number of different cards: tag36h11 has 587 tags.
inline constexpr int kStandardWands = 587 / kPanels;
/// The tag for the back of any wand, which is not a wand's own: a visitor who turns the wand chooses another language.
inline constexpr int kBackTag = 586;
static_assert(kBackTag >= kPanels * kStandardWands);

/// Returns the wand folded from card `number`, with the tags 3 number, 3 number + 1 and 3 number + 2 from left to
/// right. Precondition: `number` is 0 to kStandardWands - 1.
[[nodiscard]] Wand standard_wand(int number, const FoldedCard& card = {});

}  // namespace cyclorama
