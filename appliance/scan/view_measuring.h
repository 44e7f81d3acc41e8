// SPDX-License-Identifier: Apache-2.0
/// Measures one projector from one direction: finds its light, chooses the exposure, shows and photographs the
/// patterns, and decodes correspondences.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "appliance/scan/scan_devices.h"
#include "appliance/scan/scan_view.h"
#include "appliance/structured_light/decode_quality.h"
#include "appliance/structured_light/decoder.h"
#include "appliance/structured_light/exposure.h"
#include "appliance/structured_light/pattern_set.h"
#include "common/base/result.h"

namespace cyclorama::scan {

/// Settings for the measurement of a view. The defaults (all bits of the Gray code and nothing else) were chosen with
/// `./bench.sh calibration-trade` and in a room at full size (docs/trade.md).
struct ViewSettings {
  int finest_bit = 0;  ///< For this member and the next three, see PatternChoice.
  int base_bit = -1;
  double phase_period_px = 0.0;
  int phase_steps = 0;
  int photographs = 1;  ///< Photographs of each picture, which are averaged.
  structured_light::DecodeSettings decode{};
  structured_light::ExposureLimits exposure{};

  /// Returns a text that identifies these settings in ScanIdentity::patterns: views that were measured differently are
  /// not combined.
  [[nodiscard]] std::string text() const;
};

/// Receives each photograph, for progress displays.
using PhotographListener =
    std::function<void(const std::string& picture, double fraction, const ScanPhotograph& photograph)>;

struct ViewOrder {
  std::size_t projector = 0;
  std::string name;  ///< Name of the projector.
  int width_px = 0;
  int height_px = 0;
  /// Start of the search for the exposure, such as the previous view's exposure; may be absent.
  std::optional<double> exposure_s{};
};

/// Returns the mean of the channels.
[[nodiscard]] structured_light::Photo photo_of(const ScanPhotograph& photograph);

/// Takes one photograph and checks its size. Errors: kUnavailable ("cancelled") if `stop` was requested; kBadData if
/// the size has changed; otherwise those of ScanCamera::photograph().
Result<ScanPhotograph> take_photograph(ScanCamera& camera, double exposure_s, const std::stop_token& stop);

/// Measures one view. Precondition: all other projectors are dark; on return this projector is dark too. A view in
/// which the projector lights nothing has no correspondences and exposure 0; this is not an error, because no direction
/// sees all projectors. Errors: kUnavailable ("cancelled") if `stop` was requested; otherwise those of the devices and
/// of next_exposure(). Blocks.
Result<ScanView> measure_view(const ViewOrder& order, const ViewSettings& settings, PatternScreen& screen,
                              ScanCamera& camera, const PhotographListener& listener, std::stop_token stop);

/// Returns the error of a cancelled scan.
[[nodiscard]] Error cancelled();

}  // namespace cyclorama::scan
