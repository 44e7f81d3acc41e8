// SPDX-License-Identifier: Apache-2.0
/// Interfaces to the displays, which report the pictures that they show, and to the cameras that watch the wall.
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

/// A fixed camera and its lens; its pose is measured (camera_placement.h).
struct WatchingCamera {
  std::string name;
  calibration::BrownParameters lens;
};

/// Displays and cameras while the show runs. Thread-bound.
class ShowRoom {
 public:
  virtual ~ShowRoom() = default;

  /// Returns the next picture of each camera, and the pictures that the displays showed from before the first exposure
  /// on. A camera that gives no picture is left out and named in `ret_troubles`. Blocks for the longest exposure and
  /// some refreshes. Errors: kUnavailable, kTimedOut if a display cannot be reached, with its name.
  virtual Result<ShowMoment> next(std::vector<std::string>* ret_troubles) = 0;

 protected:
  ShowRoom() = default;
  ShowRoom(const ShowRoom&) = delete;
  ShowRoom& operator=(const ShowRoom&) = delete;
};

/// Cameras and pattern screen with which cameras are placed.
struct PlacementDevices {
  std::vector<std::unique_ptr<scan::ScanCamera>> cameras;  ///< In the order of ShowRooms::cameras().
  std::unique_ptr<scan::PatternScreen> screen;             ///< Last, so that it is released first.
};

/// Opens a ShowRoom or PlacementDevices, one at a time, so that the cameras are free in between. Thread-bound.
class ShowRooms {
 public:
  virtual ~ShowRooms() = default;

  [[nodiscard]] virtual const std::vector<WatchingCamera>& cameras() const = 0;
  /// Returns the configured cameras that cannot watch, with reason and remedy.
  [[nodiscard]] virtual std::vector<std::string> troubles() const { return {}; }
  /// Returns the factor by which projectors' pictures are reduced, each way.
  [[nodiscard]] virtual int picture_factor() const = 0;
  virtual Result<std::unique_ptr<ShowRoom>> open() = 0;
  virtual Result<PlacementDevices> open_for_placement() = 0;

 protected:
  ShowRooms() = default;
  ShowRooms(const ShowRooms&) = delete;
  ShowRooms& operator=(const ShowRooms&) = delete;
};

}  // namespace cyclorama::healing
