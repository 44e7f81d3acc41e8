// SPDX-License-Identifier: Apache-2.0
/// Where patches of a prediction really are in a picture, to fractions of a pixel.
///
/// Inverse-compositional Lucas-Kanade: the patch's gradients are taken once, of the prediction; the picture is sampled
/// at the shift found so far. Both are brought to mean 0 and length 1, and the gradients are made orthogonal to what
/// that takes away, so gain and offset (lamps, paint, ambient light) are each patch's own.
/// Source: Baker and Matthews, "Lucas-Kanade 20 Years On", IJCV 56 (3), 2004.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/healing/estimator/prediction.h"

namespace cyclorama::healing {

enum class PatchFit {
  kFits,     ///< It is there, within `max_shift_px`.
  kDiffers,  ///< Nothing like it is there.
  kPlain,    ///< Nothing in it that could be compared.
  kShared,   ///< Of several projectors' light, or at the wall's edge.
};

struct PatchShift {
  Eigen::Vector2d at{0.0, 0.0};  ///< Its middle, in the prediction's pixels, from its corner.
  int projector = -1;            ///< Whose light it is, unless it is shared.
  PatchFit fit = PatchFit::kShared;
  Eigen::Vector2d shift{0.0, 0.0};                           ///< What is predicted at `at` is seen at `at + shift`.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< Of the shift, by the gradients and what remains.
  double likeness = 0.0;                                     ///< Normalised correlation with what is there.
  double contrast = 1.0;                                     ///< Of the picture, in units of the prediction's.
};

struct PatchOptions {
  int radius_px = 10;
  int step_px = 16;
  int max_rounds = 6;
  double max_shift_px = 4.0;
  double min_likeness = 0.8;
  double min_contrast = 0.0012;  ///< Standard deviation, of the camera's full scale.
};

/// What turns the prediction's unit into the picture's: a robust line through patches' means. 0 where there is no
/// light.
struct LightScale {
  double gain = 0.0;
  double offset = 0.0;
};
[[nodiscard]] LightScale light_scale(const Prediction& prediction, const LightPlane& picture);

/// Of the same size. Reentrant.
[[nodiscard]] std::vector<PatchShift> align_patches(const Prediction& prediction, const LightPlane& picture,
                                                    double gain, const PatchOptions& options = {});

/// The same at a quarter of the size, for shifts of up to about ten pixels; answers in the prediction's pixels. Patches
/// that look like their neighbourhood somewhere else within reach are kShared: repeating content would mislead.
[[nodiscard]] std::vector<PatchShift> align_coarsely(const Prediction& prediction, const LightPlane& picture,
                                                     double gain);

}  // namespace cyclorama::healing
