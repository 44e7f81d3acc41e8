// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "appliance/healing/estimator/patch_alignment.h"

namespace cyclorama::healing {

/// Contents of a part of a camera's picture.
enum class Area {
  kUnknown,
  kProjector,  ///< One projector's light, as predicted.
  kShared,     ///< Light of several projectors, or the wall's edge.
  kPlain,      ///< Wall without visible detail.
  kInTheWay,   ///< Differs from the prediction while other areas fit: a person stands there.
};

/// Occlusions in one camera's picture, per patch, estimated from how well predictions fitted over time. A value.
class AreaMap {
 public:
  /// Updates the estimates with the patches of one picture. Precondition: each call has the same patches, in the same
  /// order.
  void update(std::span<const PatchShift> patches);
  /// Discards the estimates, because the prediction has changed.
  void restart() { doubts_.clear(); }

  [[nodiscard]] Area area(std::size_t patch) const;
  /// Returns whether a patch has fitted for some time. A patch that fits for the first time may still be partly
  /// occluded.
  [[nodiscard]] bool is_trusted(std::size_t patch) const {
    return patch >= doubts_.size() || doubts_[patch] < kTrustedBelow;
  }
  /// Returns the share of the comparable patches that are occluded, in [0, 1].
  [[nodiscard]] double hidden() const;

 private:
  static constexpr float kGrowth = 0.35f;  // Per picture: three that differ mark a patch as occluded.
  static constexpr float kTrustedBelow = 0.3f;
  static constexpr float kInTheWayAbove = 0.6f;
  std::vector<PatchFit> fits_;
  std::vector<float> doubts_;
};

/// Numbers of one projector's patches in a camera's picture, by result.
struct PatchTally {
  int fits = 0;
  int differs = 0;
  int plain = 0;
  int faint = 0;  ///< Patches among `differs` that have only a small part of the predicted contrast.

  [[nodiscard]] int compared() const { return fits + differs; }
  PatchTally& operator+=(const PatchTally& other);
};
[[nodiscard]] std::vector<PatchTally> tally(std::span<const PatchShift> patches, std::size_t projectors);

}  // namespace cyclorama::healing
