// SPDX-License-Identifier: Apache-2.0
#include "common/wand/folded_card.h"

#include <fmt/format.h>

#include <cmath>

#include "common/base/check.h"

namespace cyclorama {

using Eigen::Vector3d;

double FoldedCard::lid_depth_m() const { return panel_width_m * std::sin(fold_rad); }

double FoldedCard::lid_half_width_m() const { return panel_width_m * (0.5 + std::cos(fold_rad)); }

FoldedCard FoldedCard::scaled(double scale) const {
  return {scale * panel_width_m, scale * panel_height_m, scale * tag_size_m, fold_rad};
}

Wand standard_wand(int number, const FoldedCard& card) {
  CHECK(number >= 0 && number < kStandardWands && card.tag_size_m > 0.0);
  Wand wand{fmt::format("wand {}", number), {}};
  const double half_panel = 0.5 * card.panel_width_m;
  const double half_tag = 0.5 * card.tag_size_m;
  // The centre of all tags: two of the three tags are behind the middle panel, by half of the lid's depth.
  const double middle_z = -card.lid_depth_m() / 3.0;
  for (int panel = 0; panel < kPanels; ++panel) {
    const int side = panel - 1;
    const double angle = side * card.fold_rad;
    const Vector3d right(std::cos(angle), 0.0, std::sin(angle));
    const Vector3d down = Vector3d::UnitY();
    const Vector3d centre = Vector3d(side * half_panel, 0.0, middle_z) + side * half_panel * right;
    WandTag tag{kPanels * number + panel, card.tag_size_m, {}};
    tag.corners = {centre - half_tag * (right + down), centre + half_tag * (right - down),
                   centre + half_tag * (right + down), centre - half_tag * (right - down)};
    wand.tags.push_back(tag);
  }
  return wand;
}

}  // namespace cyclorama
