// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/output/drm/canvas.h"
#include "drivers/output/output.h"

namespace cyclorama::output {

struct DrmHead {
  HeadMode mode;          ///< The picture that is drawn, before it is turned.
  std::string connector;  ///< "HDMI-A-1", "1:HDMI-A-1" on the second card, or empty: any that is free.
  Rotation rotation = Rotation::kNone;
};

struct DrmOptions {
  std::vector<DrmHead> heads;
  double refresh_hz = 60.0;                  ///< Of the modes that are looked for.
  std::vector<std::filesystem::path> cards;  ///< The first one draws. Empty: all of the machine's that have connectors.
  std::chrono::milliseconds flip_timeout{500};
  /// While false, all connectors are off (ACTIVE = 0). Null: always on. Outlives the output; another thread may write
  /// it.
  const std::atomic<bool>* is_awake = nullptr;
};

/// Heads on the connectors of one or several graphics cards, all of a card flipped by one atomic commit.
///
/// A head without a projector is drawn all the same and shown as soon as one comes; its size is the installation's,
/// scaled to whatever mode the projector takes. Whatever fails is tried again at the next refreshes: a projector that
/// is off or was swapped, another program that took the card (master), a flip that never came, a modeset that was
/// refused. While nothing is lit, refreshes go on at the requested rate. Makes its GL context current on the calling
/// thread. present() waits for the flip and leaves no GL binding as it was.
///
/// kInvalidArgument  no head, a size, rate or connector's name that cannot be.   kNotFound, kBusy, kUnavailable,
/// kSystem a card cannot be opened or drawn with, and why.   Later: kUnavailable  the graphics processor was reset, or
/// a card is gone, or nothing helps. `clock` must outlive the output.
Result<std::unique_ptr<Output>> open_drm_output(const DrmOptions& options, const Clock& clock);

}  // namespace cyclorama::output
