// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/room/installation.h"
#include "drivers/output/drm/drm_output.h"
#include "drivers/output/headless/headless_output.h"

namespace cyclorama {

/// Which output, and where each projector hangs on it.
struct OutputChoice {
  enum class Kind { kHeadless, kDrm };
  /// A projector's connector and how its picture is turned.
  struct Head {
    std::string projector;
    std::string connector;
    Rotation rotation = Rotation::kNone;
  };

  Kind kind = Kind::kHeadless;
  HeadlessOptions::Renderer renderer = HeadlessOptions::Renderer::kAny;  ///< Headless.
  std::filesystem::path run_dir;             ///< Headless: for shared pictures; empty: none.
  std::vector<Head> heads;                   ///< DRM: those not named here take what connector is free.
  std::vector<std::filesystem::path> cards;  ///< DRM: the first one draws; empty: all.
};

/// "left=HDMI-A-1", "left=1:HDMI-A-1" on the second card, "left=HDMI-A-1,90" turned clockwise by 0, 90, 180 or 270
/// degrees. kInvalidArgument  another form.
Result<OutputChoice::Head> parse_head(std::string_view text);

/// Errors of open_headless_output() and open_drm_output(); kInvalidArgument  a head of a projector that is not
/// installed.
Result<std::unique_ptr<Output>> make_output(const OutputChoice& choice, const Installation& installation,
                                            double refresh_hz, const Clock& clock);

}  // namespace cyclorama
