// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/vrpn.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "appliance/tracker/interchange/bytes.h"

namespace cyclorama::tracker {
namespace {

constexpr std::size_t kHeaderBytes = 24;
constexpr std::size_t kAlign = 8;
constexpr std::int32_t kSenderName = -1;
constexpr std::int32_t kTypeName = -2;
constexpr std::string_view kPoseType = "vrpn_Tracker Pos_Quat";
constexpr std::size_t kPoseBytes = 8 + 7 * 8;
constexpr std::size_t kMaxNameLength = 100;  // VRPN's own limit.
constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int32_t kOurSender = 0;
constexpr std::int32_t kOurType = 0;

Error bad(std::string_view what) { return {ErrorCode::kBadData, fmt::format("no VRPN datagram: {}", what)}; }

void write_message(PacketWriter* out, const PoseReport& report, std::int32_t sender, std::int32_t type,
                   std::vector<std::byte> body) {
  out->u32(static_cast<std::uint32_t>(kHeaderBytes + body.size()));
  const std::int64_t seconds = report.time_ns / kSecondNs;
  out->u32(static_cast<std::uint32_t>(seconds));
  out->u32(static_cast<std::uint32_t>((report.time_ns - seconds * kSecondNs) / 1000));
  out->i32(sender);
  out->i32(type);
  out->u32(static_cast<std::uint32_t>(report.sequence));
  out->raw(body);
  out->pad(kAlign);
}

std::vector<std::byte> name_body(std::string_view name) {
  PacketWriter body;
  body.u32(static_cast<std::uint32_t>(name.size() + 1));
  body.text(name);
  body.text(std::string_view("\0", 1));
  return body.take();
}

Result<std::string> read_name(std::span<const std::byte> body) {
  PacketReader reader(body);
  const std::uint32_t size = reader.u32();
  if (reader.is_short() || size == 0 || size > kMaxNameLength + 1 || size != reader.left())
    return bad("a name's length");
  std::string name;
  for (const std::byte b : reader.bytes(size)) name += std::to_integer<char>(b);
  name.pop_back();
  if (body.back() != std::byte{0} || name.find('\0') != std::string::npos) return bad("a name's end");
  return name;
}

}  // namespace

std::vector<std::byte> encode_vrpn(const PoseReport& report, const std::string& device) {
  if (!report.found) return {};
  PacketWriter out;
  write_message(&out, report, kOurSender, kSenderName, name_body(std::string_view(device).substr(0, kMaxNameLength)));
  write_message(&out, report, kOurType, kTypeName, name_body(kPoseType));
  PacketWriter body;
  body.i32(report.sensor);
  body.i32(0);
  for (const double value : report.position_m) body.f64(value);
  for (const std::size_t i : {1U, 2U, 3U, 0U}) body.f64(report.rotation[i]);
  write_message(&out, report, kOurSender, kOurType, body.take());
  return out.take();
}

Status VrpnReader::take(const Message& message, std::vector<PoseReport>* ret_reports) {
  if (message.type == kSenderName || message.type == kTypeName) {
    TRY_ASSIGN(std::string name, read_name(message.body));
    auto& names = message.type == kSenderName ? senders_ : types_;
    if (names.size() < kMaxNames || names.contains(message.sender)) names[message.sender] = std::move(name);
    return Done{};
  }
  const auto type = types_.find(message.type);
  const auto sender = senders_.find(message.sender);
  if (type == types_.end() || type->second != kPoseType) return Done{};
  if (!device_.empty() && (sender == senders_.end() || sender->second != device_)) return Done{};
  if (message.body.size() != kPoseBytes) return bad("a pose's length");
  PacketReader reader(message.body);
  PoseReport report;
  report.sensor = reader.i32();
  reader.i32();
  report.sequence = ++sequence_;
  report.time_ns = message.time_ns;
  report.found = true;
  for (double& value : report.position_m) value = reader.f64();
  for (const std::size_t i : {1U, 2U, 3U, 0U}) report.rotation[i] = reader.f64();
  ret_reports->push_back(report);
  return Done{};
}

Result<std::vector<PoseReport>> VrpnReader::read(std::span<const std::byte> datagram) {
  std::vector<PoseReport> reports;
  PacketReader reader(datagram);
  while (!reader.is_empty()) {
    const std::uint32_t length = reader.u32();
    Message message;
    const std::int64_t seconds = reader.u32();
    const std::int64_t microseconds = reader.u32();
    message.time_ns = seconds * kSecondNs + microseconds * 1000;
    message.sender = reader.i32();
    message.type = reader.i32();
    reader.u32();
    if (reader.is_short() || length < kHeaderBytes || length - kHeaderBytes > reader.left()) return bad("a length");
    message.body = reader.bytes(length - kHeaderBytes);
    reader.bytes((kAlign - message.body.size() % kAlign) % kAlign);
    if (reader.is_short()) return bad("a message that is not padded");
    TRY(take(message, &reports));
  }
  return reports;
}

}  // namespace cyclorama::tracker
