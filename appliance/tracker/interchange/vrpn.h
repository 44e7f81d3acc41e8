// SPDX-License-Identifier: Apache-2.0
/// Messages of trackers in the Virtual-Reality Peripheral Network (VRPN), as sent over UDP.
///
/// Source: VRPN's description of its protocol (Protocol.md, R. Pavlik, Collabora 2018, for versions 07.xx); quatlib for
/// the order of a quaternion's numbers. A datagram contains messages one after the other:
///
///   u32 length (24 + body)  u32 seconds  u32 microseconds  i32 sender  i32 type  u32 sequence  body, padded to 8
///
///   type -1   names a sender: the header's sender is its number, the body u32 length and the name with its NUL
///   type -2   names a type: the header's sender is the type's number
///   "vrpn_Tracker Pos_Quat": i32 sensor, i32 padding, f64 x y z, f64 quaternion x y z w
///
/// The connection is omitted: VRPN announces numbers and names once, over TCP. Here every datagram begins with the
/// names that it needs, in VRPN's format, so that a receiver may start at any time.
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

/// Returns `report` as a datagram of the tracker `device`, such as "Cyclorama0". Empty if the sensor is out of sight,
/// which VRPN cannot express: nothing is sent then.
[[nodiscard]] std::vector<std::byte> encode_vrpn(const PoseReport& report, const std::string& device);

/// Reads the datagrams of one sender, in order, since names may have come in an earlier datagram. A value.
class VrpnReader {
 public:
  /// Reads only the poses of `device`; empty: those of all devices.
  explicit VrpnReader(std::string device) : device_(std::move(device)) {}

  /// Returns the poses in a datagram, with sequence numbers of this reader. Messages of other kinds are skipped.
  /// Errors: kBadData if a length does not match its contents, since the rest of the datagram then has no meaning.
  Result<std::vector<PoseReport>> read(std::span<const std::byte> datagram);

  /// Maximum number of names of each kind; no tracker's sender has more.
  static constexpr std::size_t kMaxNames = 1024;

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
