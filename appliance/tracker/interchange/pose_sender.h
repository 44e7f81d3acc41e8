// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "appliance/tracker/interchange/datagram.h"
#include "appliance/tracker/interchange/pose_report.h"

namespace cyclorama::tracker {

/// Tells other programs each pose, by OSC and by VRPN's datagrams. What the network does not take is lost.
/// Thread-bound.
class PoseSender {
 public:
  /// Empty addresses are not spoken to. `device` is the tracker's name in VRPN. Errors as DatagramSender::open().
  static Result<PoseSender> open(const std::string& osc, const std::string& vrpn, std::string device);
  void say(const PoseReport& report) const;

 private:
  explicit PoseSender(std::string device) : device_(std::move(device)) {}
  std::optional<DatagramSender> osc_;
  std::optional<DatagramSender> vrpn_;
  std::string device_;
};

}  // namespace cyclorama::tracker
