// SPDX-License-Identifier: Apache-2.0
/// One projector from one direction: light found, exposure chosen, patterns shown and photographed, places decoded.
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

/// How every view is measured. The defaults, all bits of the Gray code and nothing else, are chosen on the curve of
/// `./bench.sh calibration-trade` and on a room at full size (docs/trade.md).
struct ViewSettings {
  int finest_bit = 0;  ///< As PatternChoice's, all five.
  int base_bit = -1;
  double phase_period_px = 0.0;
  int phase_steps = 0;
  int photographs = 1;  ///< Of each picture, averaged.
  structured_light::DecodeSettings decode{};
  structured_light::ExposureLimits exposure{};

  /// Views that were measured otherwise are not put together: ScanIdentity::patterns.
  [[nodiscard]] std::string text() const;
};

/// For people who wait.
using PhotographListener =
    std::function<void(const std::string& picture, double fraction, const ScanPhotograph& photograph)>;

struct ViewOrder {
  std::size_t projector = 0;
  std::string name;  ///< Of it.
  int width_px = 0;
  int height_px = 0;
  /// Where the search for the exposure begins: what was right before. Nothing: anywhere.
  std::optional<double> exposure_s{};
};

/// Codes as Photo: mean of the channels.
[[nodiscard]] structured_light::Photo photo_of(const ScanPhotograph& photograph);

/// One of the size that the camera told. kUnavailable  `stop` was requested, with "cancelled".     kBadData  it has
/// another size than before. Others as ScanCamera::photograph().
Result<ScanPhotograph> take_photograph(ScanCamera& camera, double exposure_s, const std::stop_token& stop);

/// All other projectors must be dark; this one is, afterwards. A view in which the projector lights nothing has no
/// places and exposure 0, and is no error: projectors do not reach everywhere.
/// kUnavailable  `stop` was requested, with "cancelled"; else the devices' errors, and of next_exposure(). Blocks.
Result<ScanView> measure_view(const ViewOrder& order, const ViewSettings& settings, PatternScreen& screen,
                              ScanCamera& camera, const PhotographListener& listener, std::stop_token stop);

/// What a cancelled scan ends with.
[[nodiscard]] Error cancelled();

}  // namespace cyclorama::scan
