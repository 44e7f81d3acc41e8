// SPDX-License-Identifier: Apache-2.0
/// What keeping a wall in its place works with: the displays that tell what they show, and the cameras that see it.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "appliance/healing/estimator/camera_monitor.h"
#include "appliance/healing/estimator/continuous_calibrator.h"
#include "appliance/scan/scan_devices.h"
#include "common/base/result.h"

namespace cyclorama::healing {

/// A fixed camera and its lens; where it stands is found out (camera_places.h).
struct WatchingCamera {
  std::string name;
  calibration::BrownParameters lens;
};

/// Displays and cameras while the show runs. Thread-bound.
class ShowRoom {
 public:
  virtual ~ShowRoom() = default;

  /// The next picture of each camera, and what was shown from before the first of them was exposed. A camera that gives
  /// none is left out, and said in `ret_troubles`. Blocks for the longest exposure and some refreshes.
  /// kUnavailable, kTimedOut  a display cannot be asked: says which.
  virtual Result<ShowMoment> next(std::vector<std::string>* ret_troubles) = 0;

 protected:
  ShowRoom() = default;
  ShowRoom(const ShowRoom&) = delete;
  ShowRoom& operator=(const ShowRoom&) = delete;
};

/// The same cameras and projectors while patterns are shown.
struct PlacementDevices {
  std::vector<std::unique_ptr<scan::ScanCamera>> cameras;  ///< As ShowRooms::cameras().
  std::unique_ptr<scan::PatternScreen> screen;             ///< Last: it is let go first.
};

/// Makes either, one at a time; so the cameras are free between. Thread-bound.
class ShowRooms {
 public:
  virtual ~ShowRooms() = default;

  [[nodiscard]] virtual const std::vector<WatchingCamera>& cameras() const = 0;
  /// Cameras that were named and cannot watch: why, and what to do about it.
  [[nodiscard]] virtual std::vector<std::string> troubles() const { return {}; }
  /// By what pictures of projectors are smaller each way than they are.
  [[nodiscard]] virtual int picture_factor() const = 0;
  virtual Result<std::unique_ptr<ShowRoom>> open() = 0;
  virtual Result<PlacementDevices> open_for_placement() = 0;

 protected:
  ShowRooms() = default;
  ShowRooms(const ShowRooms&) = delete;
  ShowRooms& operator=(const ShowRooms&) = delete;
};

}  // namespace cyclorama::healing
