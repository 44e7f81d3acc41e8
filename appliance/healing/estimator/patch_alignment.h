// SPDX-License-Identifier: Apache-2.0
/// Finds the positions of a prediction's patches in a picture, to fractions of a pixel.
///
/// Inverse-compositional Lucas-Kanade: the patch's gradients are computed once, from the prediction; the picture is
/// sampled at the shift found so far. Both are normalised to mean 0 and length 1, and the gradients are made orthogonal
/// to the components that the normalisation removes, so that gain and offset (lamps, paint, ambient light) are free per
/// patch. Source: Baker and Matthews, "Lucas-Kanade 20 Years On", IJCV 56 (3), 2004.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/healing/estimator/prediction.h"

namespace cyclorama::healing {

enum class PatchFit {
  kFits,     ///< Found within PatchOptions::max_shift_px of its predicted position.
  kDiffers,  ///< Nothing similar was found.
  kPlain,    ///< Contains no detail to compare.
  kShared,   ///< Not comparable: several projectors' light, the wall's or picture's edge, or repeating content.
};

struct PatchShift {
  Eigen::Vector2d at{0.0, 0.0};  ///< Centre, in the prediction's pixels, from its corner.
  int projector = -1;            ///< Projector that lights the patch; -1 if there is no single one.
  PatchFit fit = PatchFit::kShared;
  Eigen::Vector2d shift{0.0, 0.0};  ///< The patch predicted at `at` is seen at `at + shift`.
  /// Covariance of the shift, from the gradients and the residual.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  double likeness = 0.0;  ///< Normalised correlation with the picture.
  double contrast = 1.0;  ///< Contrast of the picture relative to the prediction's.
};

struct PatchOptions {
  int radius_px = 10;
  int step_px = 16;
  int max_rounds = 6;
  double max_shift_px = 4.0;
  double min_likeness = 0.8;
  double min_contrast = 0.0012;  ///< Standard deviation, as a share of the camera's full scale.
};

/// Conversion from the prediction's unit to the picture's: a robust line through the means of blocks. The gain is 0 if
/// there is no light.
struct LightScale {
  double gain = 0.0;
  double offset = 0.0;
};
[[nodiscard]] LightScale light_scale(const Prediction& prediction, const LightPlane& picture);

/// Searches all patches of a prediction in a picture. Precondition: the two have the same size. Reentrant.
[[nodiscard]] std::vector<PatchShift> align_patches(const Prediction& prediction, const LightPlane& picture,
                                                    double gain, const PatchOptions& options = {});

/// Aligns at a quarter of the size, for shifts of up to 16 pixels; returns the shifts in the prediction's pixels.
/// Patches that also resemble another position nearby are kShared, since repeating content has no unique position.
[[nodiscard]] std::vector<PatchShift> align_coarsely(const Prediction& prediction, const LightPlane& picture,
                                                     double gain);

}  // namespace cyclorama::healing
