// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/room/installation.h"
#include "drivers/output/drm/drm_output.h"
#include "drivers/output/headless/headless_output.h"

namespace cyclorama::display {

/// Which output; and what the installation's file says otherwise of cards and plugs.
struct OutputChoice {
  enum class Kind { kHeadless, kDrm };
  /// A projector's connector and how its picture is turned.
  struct Head {
    std::string projector;
    std::string connector;
    output::Rotation rotation = output::Rotation::kNone;
  };

  Kind kind = Kind::kHeadless;
  output::HeadlessOptions::Renderer renderer = output::HeadlessOptions::Renderer::kAny;  ///< Headless.
  std::filesystem::path run_dir;             ///< Headless: for shared pictures; empty: none.
  std::vector<Head> heads;                   ///< DRM: those not named here hang where the installation says.
  std::vector<std::filesystem::path> cards;  ///< DRM: in the place of the installation's, unless empty.
  /// While false, the heads are dark. Null: always on. Outlives the output; another thread may write it.
  const std::atomic<bool>* is_awake = nullptr;
};

/// "left=HDMI-A-1", "left=1:HDMI-A-1" on the second card, "left=HDMI-A-1,90" turned clockwise by 0, 90, 180 or 270
/// degrees. kInvalidArgument  another form.
Result<OutputChoice::Head> parse_head(std::string_view text);

/// What is asked of a DRM output. kInvalidArgument  a head of a projector that is not installed.
Result<output::DrmOptions> drm_options(const OutputChoice& choice, const Installation& installation, double refresh_hz);

/// Errors of open_headless_output(), drm_options() and open_drm_output().
Result<std::unique_ptr<output::Output>> make_output(const OutputChoice& choice, const Installation& installation,
                                                    double refresh_hz, const Clock& clock);

}  // namespace cyclorama::display
