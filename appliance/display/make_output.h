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

/// The choice of output, and overrides of the installation's cards and connectors.
struct OutputChoice {
  enum class Kind { kHeadless, kDrm };
  /// A projector's connector, and the rotation of its picture.
  struct Head {
    std::string projector;
    std::string connector;
    output::Rotation rotation = output::Rotation::kNone;
  };

  Kind kind = Kind::kHeadless;
  output::HeadlessOptions::Renderer renderer = output::HeadlessOptions::Renderer::kAny;  ///< Headless: renderer.
  std::filesystem::path run_dir;             ///< Headless: folder for shared pictures; empty: none.
  std::vector<Head> heads;                   ///< DRM: heads that differ from the installation's connectors.
  std::vector<std::filesystem::path> cards;  ///< DRM: replaces the installation's cards unless empty.
  /// While it is false, the heads are dark; null: they are never dark. It must outlive the output; another thread may
  /// write it.
  const std::atomic<bool>* is_awake = nullptr;
};

/// Parses "left=HDMI-A-1"; "left=1:HDMI-A-1" for a connector of the second card; "left=HDMI-A-1,90" for a picture
/// turned clockwise by 0, 90, 180 or 270 degrees. Errors: kInvalidArgument if `text` has another form.
Result<OutputChoice::Head> parse_head(std::string_view text);

/// Returns the options of a DRM output. Errors: kInvalidArgument if a head's projector is not installed; those of
/// read_edid_to_drive().
Result<output::DrmOptions> drm_options(const OutputChoice& choice, const Installation& installation, double refresh_hz);

/// Opens the chosen output. Errors: those of open_headless_output(), drm_options() and open_drm_output().
Result<std::unique_ptr<output::Output>> make_output(const OutputChoice& choice, const Installation& installation,
                                                    double refresh_hz, const Clock& clock);

}  // namespace cyclorama::display
