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

/// The defaults were chosen on the curves of docs/design/structured-light.md (`./bench.sh calibration-real` prints
/// them).
struct DecodeSettings {
  double saturated = 0.98;  ///< Of the white picture, as Photo.
  double darkest = 0.04;    ///< Direct light below this is none, as Photo; never less than 3 deviations.
  /// Direct light below this share of the amplitude is none: the rest came by way of other walls, or of a second pane.
  /// With XOR codes, which see through such light, a tenth does.
  double min_direct_share = 0.6;
  BitThreshold undecided = {2.0, 0.1};  ///< What a bit's difference must exceed.
  double disturbance = 0.12;            ///< Deviation of pattern and inverse's sum, of the amplitude, beyond noise.
  double max_sigma_px = 0.3;            ///< A pixel that is less sure of its place than this has an unstable bit.
  int min_patch_px = 60;
};

/// Photographs of a pattern set, one by one in the set's order, to a place on the projector for every camera pixel.
///
///   add() × the set's pictures ─▶ finish()
///
/// Every bit must be followed by its inverse. Memory: about 4 bytes a pixel and picture pair. OpenCV's structured-light
/// module has a decoder of the same pictures (a test compares both): it gives whole pixels only, without sigma or
/// reason, and drops every pixel that lies on any stripe's edge. Thread-bound.
class Decoder {
 public:
  /// kInvalidArgument  a set without white and black, bits without inverses, more than 16 bits, or no pixels.
  static Result<Decoder> from(const PatternSet& set, const DecodeSettings& settings, int width_px, int height_px);

  /// kInvalidArgument  the photograph has another size, or the set has no picture left.
  Status add(const Photo& photo);
  /// kInvalidArgument  photographs are missing.     kBadData  the projector lights nothing, with what to look at.
  /// The decoder can be asked again with other settings.
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
  Photo pattern_;  ///< Waits for its inverse.
  int pairs_ = 0;
  Image<float, 2> sums_;  ///< Mean of pattern and inverse's sum so far, and the sum of squared deviations from it.
  Image<float, 1> min_;   ///< Least light of the pictures that tell direct light from global.
  Image<float, 1> max_;
  std::array<AxisBits, 2> axes_;
  std::array<PhaseReading, 2> phases_;
};

}  // namespace cyclorama::structured_light
