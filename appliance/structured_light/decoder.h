// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "appliance/structured_light/bit_reading.h"
#include "appliance/structured_light/decoded.h"
#include "appliance/structured_light/pattern_set.h"
#include "appliance/structured_light/phase_reading.h"
#include "appliance/structured_light/photo.h"
#include "common/base/result.h"

namespace cyclorama::structured_light {

/// Settings of a decoder. The defaults were chosen by the curves in docs/design/structured-light.md, which `./bench.sh
/// calibration-real` prints.
struct DecodeSettings {
  double saturated = 0.98;  ///< Clipping level of the white picture, in units of Photo.
  double darkest = 0.04;    ///< Minimum direct light, in units of Photo; at least 3 sigma.
  /// Direct light below this fraction of the amplitude counts as none: the pixel is lit by way of other surfaces or of
  /// a second pane. With XOR codes, which suppress this light, 0.1 suffices.
  double min_direct_share = 0.6;
  BitThreshold undecided = {2.0, 0.1};  ///< Minimum difference that decides a bit.
  /// Maximum standard deviation of the sum of pattern and inverse, relative to the amplitude, beyond noise.
  double disturbance = 0.12;
  double max_sigma_px = 0.3;  ///< A pixel with a larger sigma becomes kUnstableBit.
  int min_patch_px = 60;
};

/// Decodes the photographs of a pattern set to a projector position for every camera pixel. The photographs are passed
/// one by one, in the set's order.
///
///   add() × the set's pictures ─▶ finish()
///
/// Every bit must be followed by its inverse. Memory: about 4 bytes per pixel and picture pair. OpenCV's
/// structured-light module decodes the same pictures (a test compares both), but gives only whole pixels, without sigma
/// or PixelFate, and omits every pixel on a stripe's edge. Thread-bound.
class Decoder {
 public:
  /// Creates a decoder for photographs of the given size. Errors: kInvalidArgument for a set without white and black,
  /// bits without inverses, more than 16 bits, or no pixels.
  static Result<Decoder> from(const PatternSet& set, const DecodeSettings& settings, int width_px, int height_px);

  /// Adds the photograph of the set's next picture. Errors: kInvalidArgument if the photograph has another size or the
  /// set has no picture left.
  Status add(const Photo& photo);
  /// Decodes the photographs; may be called again with other settings. Errors: kInvalidArgument if photographs are
  /// missing; kBadData, with the remedy, if the projector lights nothing.
  [[nodiscard]] Result<Decoded> finish() const { return finish(settings_); }
  [[nodiscard]] Result<Decoded> finish(const DecodeSettings& settings) const;

 private:
  Decoder(const PatternSet& set, const DecodeSettings& settings, int width_px, int height_px);
  void add_pair(const PatternPicture& picture, const Photo& pattern, const Photo& inverse);
  void judge_light(const DecodeSettings& settings, Decoded* decoded) const;
  [[nodiscard]] double measured_noise(const Image<float, 1>& amplitude) const;

  PatternSet set_;
  DecodeSettings settings_;
  int width_px_;
  int height_px_;
  std::size_t next_ = 0;
  Photo white_;
  Photo black_;
  Photo pattern_;  ///< Pattern whose inverse has not been added yet.
  int pairs_ = 0;
  Image<float, 2> sums_;  ///< Mean of the sum of pattern and inverse, and sum of squared deviations.
  Image<float, 1> min_;   ///< Minimum over the pictures that separate direct and global light.
  Image<float, 1> max_;
  std::array<AxisBits, 2> axes_;
  std::array<PhaseReading, 2> phases_;
};

}  // namespace cyclorama::structured_light
