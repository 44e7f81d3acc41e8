// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/pose_sender.h"

#include <utility>

#include "appliance/tracker/interchange/osc_pose.h"
#include "appliance/tracker/interchange/vrpn.h"

namespace cyclorama::tracker {

Result<PoseSender> PoseSender::open(const std::string& osc, const std::string& vrpn, std::string device) {
  PoseSender speaker(std::move(device));
  if (!osc.empty()) {
    TRY_ASSIGN(speaker.osc_, DatagramSender::open(osc));
  }
  if (!vrpn.empty()) {
    TRY_ASSIGN(speaker.vrpn_, DatagramSender::open(vrpn));
  }
  return speaker;
}

void PoseSender::say(const PoseReport& report) const {
  if (osc_) osc_->send(encode_osc(to_osc(report)));
  if (vrpn_) vrpn_->send(encode_vrpn(report, device_));
}

}  // namespace cyclorama::tracker
