// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "appliance/healing/estimator/patch_alignment.h"

namespace cyclorama::healing {

/// What a part of a camera's picture is.
enum class Area {
  kUnknown,
  kProjector,  ///< One projector's light, as predicted.
  kShared,     ///< Several projectors', or at the wall's edge.
  kPlain,      ///< Wall on which nothing is to be seen.
  kInTheWay,   ///< It does not look as predicted, while others do: somebody stands there.
};

/// Who is where in one camera's picture, patch by patch, from how well predictions fitted over time. A value.
class AreaMap {
 public:
  /// The same patches, in the same order, each time.
  void update(std::span<const PatchShift> patches);
  /// All that was doubted is forgotten: the prediction is a new one.
  void restart() { doubts_.clear(); }

  [[nodiscard]] Area area(std::size_t patch) const;
  /// Whether a patch that fits now did so before: its edge may hold somebody still.
  [[nodiscard]] bool is_trusted(std::size_t patch) const {
    return patch >= doubts_.size() || doubts_[patch] < kTrustedBelow;
  }
  /// Of what could be compared, how much is in the way, in [0, 1].
  [[nodiscard]] double hidden() const;

 private:
  static constexpr float kGrowth = 0.35f;  // Per picture: three that differ are somebody, five that fit are nobody.
  static constexpr float kTrustedBelow = 0.3f;
  static constexpr float kInTheWayAbove = 0.6f;
  std::vector<PatchFit> fits_;
  std::vector<float> doubts_;
};

/// How many patches of one projector a camera could compare, and how they did.
struct PatchTally {
  int fits = 0;
  int differs = 0;
  int plain = 0;
  int faint = 0;  ///< Of those that differ: with a small part of the contrast that was predicted.

  [[nodiscard]] int compared() const { return fits + differs; }
  PatchTally& operator+=(const PatchTally& other);
};
[[nodiscard]] std::vector<PatchTally> tally(std::span<const PatchShift> patches, std::size_t projectors);

}  // namespace cyclorama::healing
