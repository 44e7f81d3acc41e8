// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "appliance/tracker/interchange/datagram.h"
#include "appliance/tracker/interchange/osc_pose.h"
#include "appliance/tracker/interchange/pose_report.h"
#include "appliance/tracker/interchange/vrpn.h"
#include "common/base/clock.h"

namespace cyclorama::hand {

/// Messages of other programs: poses that replace those of Cyclorama's tracker, steering commands, and requests for stops
/// and captions.
struct ReceivedPoses {
  std::vector<tracker::PoseReport> poses;
  std::optional<std::array<double, 3>> steer;    ///< The newest command: forward, right, turn.
  std::optional<tracker::OscStop> stop;          ///< The newest request for a stop.
  std::optional<tracker::OscCaptions> captions;  ///< The newest request for languages on the wall.
};

/// Listens to OSC at one port and to VRPN at another. If several sensors send poses, the first keeps control until it
/// has been silent for a second. Invalid packets are counted, and change nothing. Thread-bound.
class PoseListener {
 public:
  /// An empty address disables its protocol. For `vrpn_device` see VrpnReader. Errors: those of
  /// DatagramReceiver::open().
  static Result<PoseListener> open(const std::string& osc, const std::string& vrpn, const std::string& vrpn_device);

  /// Returns all messages that have arrived. Does not block.
  [[nodiscard]] ReceivedPoses take(TimePoint now);
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  /// Returns the port, or 0 if the protocol is disabled.
  [[nodiscard]] int osc_port() const { return osc_ ? osc_->port() : 0; }
  [[nodiscard]] int vrpn_port() const { return vrpn_ ? vrpn_->port() : 0; }

  static constexpr Duration kKept = std::chrono::seconds(1);

 private:
  explicit PoseListener(const std::string& vrpn_device) : reader_(vrpn_device) {}
  void add(const tracker::PoseReport& report, TimePoint now, ReceivedPoses* ret_heard);
  std::optional<tracker::DatagramReceiver> osc_;
  std::optional<tracker::DatagramReceiver> vrpn_;
  tracker::VrpnReader reader_;
  std::optional<std::int32_t> sensor_;
  TimePoint sensor_seen_at_{};
  std::uint64_t refused_ = 0;
};

}  // namespace cyclorama::hand
