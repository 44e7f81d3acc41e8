// SPDX-License-Identifier: Apache-2.0
#include "appliance/hand/pose_listener.h"

#include <utility>

namespace cyclorama::hand {
namespace {

constexpr int kMaxDatagrams = 1000;  // Limit per call, so that a flood does not block other work.

}  // namespace

Result<PoseListener> PoseListener::open(const std::string& osc, const std::string& vrpn,
                                        const std::string& vrpn_device) {
  PoseListener listener(vrpn_device);
  if (!osc.empty()) {
    TRY_ASSIGN(listener.osc_, tracker::DatagramReceiver::open(osc));
  }
  if (!vrpn.empty()) {
    TRY_ASSIGN(listener.vrpn_, tracker::DatagramReceiver::open(vrpn));
  }
  return listener;
}

void PoseListener::add(const tracker::PoseReport& report, TimePoint now, ReceivedPoses* ret_heard) {
  if (sensor_ && *sensor_ != report.sensor && now - sensor_seen_at_ <= kKept) return;
  if (report.found) {
    sensor_ = report.sensor;
    sensor_seen_at_ = now;
  }
  ret_heard->poses.push_back(report);
}

ReceivedPoses PoseListener::take(TimePoint now) {
  ReceivedPoses heard;
  for (int i = 0; osc_ && i < kMaxDatagrams; ++i) {
    const auto datagram = osc_->receive();
    if (!datagram) break;
    const auto messages = tracker::decode_osc(*datagram);
    if (!messages) {
      ++refused_;
      continue;
    }
    for (const tracker::OscMessage& message : *messages) {
      if (const auto pose = tracker::pose_from_osc(message)) add(*pose, now, &heard);
      if (auto stop = tracker::stop_from_osc(message)) heard.stop = std::move(stop);
      if (auto captions = tracker::captions_from_osc(message)) heard.captions = std::move(captions);
      if (const auto steer = tracker::steer_from_osc(message)) heard.steer = steer;
    }
  }
  for (int i = 0; vrpn_ && i < kMaxDatagrams; ++i) {
    const auto datagram = vrpn_->receive();
    if (!datagram) break;
    const auto reports = reader_.read(*datagram);
    if (!reports) ++refused_;
    if (!reports) continue;
    for (const tracker::PoseReport& report : *reports) add(report, now, &heard);
  }
  return heard;
}

}  // namespace cyclorama::hand
