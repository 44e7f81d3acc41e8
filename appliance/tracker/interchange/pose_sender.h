// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "appliance/tracker/interchange/datagram.h"
#include "appliance/tracker/interchange/pose_report.h"

namespace cyclorama::tracker {

/// Sends each pose to other programs, as OSC and as VRPN datagrams. Datagrams that the network does not take are lost.
/// Thread-bound.
class PoseSender {
 public:
  /// An empty address disables its protocol. `device` is the tracker's name in VRPN. Errors: those of
  /// DatagramSender::open().
  static Result<PoseSender> open(const std::string& osc, const std::string& vrpn, std::string device);
  void say(const PoseReport& report) const;

 private:
  explicit PoseSender(std::string device) : device_(std::move(device)) {}
  std::optional<DatagramSender> osc_;
  std::optional<DatagramSender> vrpn_;
  std::string device_;
};

}  // namespace cyclorama::tracker
