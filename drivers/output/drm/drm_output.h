// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/edid/edid.h"
#include "drivers/output/drm/canvas.h"
#include "drivers/output/drm/probe_runner.h"
#include "drivers/output/output.h"

namespace cyclorama::output {

struct DrmHead {
  HeadMode mode;          ///< Size of the picture that is drawn, before rotation.
  std::string connector;  ///< "HDMI-A-1", "1:HDMI-A-1" on the second card, or empty for any free connector.
  Rotation rotation = Rotation::kNone;
  std::string serial{};              ///< Serial of the projector, which is found on any connector; empty: none.
  std::optional<Edid> edid{};        ///< Replaces what the projector reports, with its timings.
  bool is_always_connected = false;  ///< Its connector is lit even if nothing seems to be connected; needs `edid`.
};

struct DrmOptions {
  std::vector<DrmHead> heads;
  double refresh_hz = 60.0;  ///< Preferred refresh rate of the modes.
  /// Cards to use; the first one renders. Empty: all cards of the machine that have connectors.
  std::vector<std::filesystem::path> cards;
  std::chrono::milliseconds flip_timeout{500};
  /// Flag that another thread may write and that must outlive the output. While it is false, all connectors are off
  /// (ACTIVE = 0). Null: always on.
  const std::atomic<bool>* is_awake = nullptr;
  /// Makes what runs the probes of connectors; empty: a thread.
  std::function<std::unique_ptr<ProbeRunner>()> make_probe_runner{};
};

/// Drives heads on the connectors of one or several graphics cards. Heads of a card with the same refresh rate flip in
/// one atomic commit; the fastest head of all sets the pace, and slower ones get the newest picture at their own rate.
///
/// A head without a projector is drawn nevertheless and shown as soon as a projector is connected; it is drawn at the
/// size given in the installation and scaled to the projector's mode. Every failure is retried at the following
/// refreshes: a projector that is off or was replaced, another program that holds the DRM master, a flip event that
/// never came, a rejected modeset. While nothing is lit, refreshes continue at the requested rate. Makes its GL context
/// current on the calling thread. present() waits for the flip and may change any GL binding. `clock` must outlive the
/// output.
///
/// Errors: kInvalidArgument if there is no head, or a size, a rate or a connector's name is invalid; kNotFound, kBusy,
/// kUnavailable or kSystem if a card cannot be opened or used for rendering, with the reason. Later calls return
/// kUnavailable if the GPU was reset, a card is gone, or retries do not help.
Result<std::unique_ptr<Output>> open_drm_output(const DrmOptions& options, const Clock& clock);

}  // namespace cyclorama::output
