// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "appliance/scan/device_lines.h"
#include "appliance/scan/scan_devices.h"
#include "common/room/installation.h"

namespace cyclorama::scan {

/// Shows patterns on the heads of remote displays through their PatternScreen service (common/wire/calibration.proto).
/// Thread-bound.
class RemotePatternScreen final : public PatternScreen {
 public:
  /// Begins a stream with every display; their heads are dark when it returns. `settle` is the projectors' delay from
  /// signal to light; each show() waits for it.
  /// Errors: kInvalidArgument if a projector belongs to no display or to two; kBusy if another calibration shows its
  /// patterns; kUnavailable or kTimedOut, with the display's address, if a display cannot be reached.
  static Result<std::unique_ptr<RemotePatternScreen>> open(const std::vector<InstalledProjector>& projectors,
                                                           const std::vector<PatternDisplay>& displays,
                                                           std::chrono::milliseconds settle);
  ~RemotePatternScreen() override;
  RemotePatternScreen(const RemotePatternScreen&) = delete;
  RemotePatternScreen& operator=(const RemotePatternScreen&) = delete;

  Status show(std::size_t projector, const RgbImage& picture) override;

 private:
  class Stream;
  struct Head {
    std::string name;
    int width_px;
    int height_px;
    std::size_t display;
  };
  RemotePatternScreen(std::vector<Head> heads, std::vector<std::unique_ptr<Stream>> streams,
                      std::chrono::milliseconds settle);

  std::vector<Head> heads_;
  std::vector<std::unique_ptr<Stream>> streams_;
  std::chrono::milliseconds settle_;
};

}  // namespace cyclorama::scan
