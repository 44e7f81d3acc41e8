// SPDX-License-Identifier: Apache-2.0
/// Trackers as the Virtual-Reality Peripheral Network has them: its messages, as they go over UDP.
///
/// Source: VRPN's own description of its protocol (Protocol.md, R. Pavlik, Collabora 2018, of versions 07.xx), and
/// quatlib's order of quaternions. A datagram holds messages one after the other:
///
///   u32 length (24 + body)  u32 seconds  u32 microseconds  i32 sender  i32 type  u32 sequence  body, padded to 8
///
///   type -1   names a sender: the header's sender is its number, the body u32 length and the name with its NUL
///   type -2   names a type: the header's sender is ITS number
///   "vrpn_Tracker Pos_Quat": i32 sensor, i32 padding, f64 x y z, f64 quaternion x y z w
///
/// What is left out is the connection: VRPN tells numbers and names once, over TCP. Here every datagram begins with the
/// names that it needs, as VRPN's are written, so that a receiver may come at any time.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "appliance/tracker/interchange/pose_report.h"
#include "common/base/result.h"

namespace cyclorama::tracker {

/// `report` of the tracker `device`, such as "Cyclorama0". VRPN has no word for a sensor that is out of sight: nothing
/// is sent then, and this is empty.
[[nodiscard]] std::vector<std::byte> encode_vrpn(const PoseReport& report, const std::string& device);

/// Reads the datagrams of one sender, one after the other, since names may have come in one before. A value.
class VrpnReader {
 public:
  /// Only `device`'s poses; empty: of every device.
  explicit VrpnReader(std::string device) : device_(std::move(device)) {}

  /// The poses in it, counted on by this reader. Messages of other kinds are passed over. Strict: kBadData where a
  /// length is not the one of what it measures, after which nothing in the datagram has a meaning.
  Result<std::vector<PoseReport>> read(std::span<const std::byte> datagram);

  static constexpr std::size_t kMaxNames = 1024;  ///< Of each kind: more are nobody's trackers.

 private:
  struct Message {
    std::int64_t time_ns = 0;
    std::int32_t sender = 0;
    std::int32_t type = 0;
    std::span<const std::byte> body;
  };
  Status take(const Message& message, std::vector<PoseReport>* ret_reports);
  std::string device_;
  std::map<std::int32_t, std::string> senders_;
  std::map<std::int32_t, std::string> types_;
  std::uint64_t sequence_ = 0;
};

}  // namespace cyclorama::tracker
