// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/osc.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "appliance/tracker/interchange/bytes.h"
#include "common/base/check.h"

namespace cyclorama::tracker {
namespace {

constexpr std::size_t kUnit = 4;
constexpr std::string_view kBundle = "#bundle";

Error bad(std::string_view what) { return {ErrorCode::kBadData, fmt::format("no OSC packet: {}", what)}; }

std::string as_text(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) text += std::to_integer<char>(b);
  return text;
}

// The functions below return through an out-parameter: gcc 12 warns falsely about a std::variant or std::string in a
// Result.

/// Reads a text with its NUL and with the zeros up to the next multiple of kUnit.
Status read_text(PacketReader* reader, std::span<const std::byte> packet, std::string* ret_text) {
  const auto rest = packet.last(reader->left());
  const auto end = std::find(rest.begin(), rest.end(), std::byte{0});
  if (end == rest.end()) return bad("a text without an end");
  const auto length = static_cast<std::size_t>(end - rest.begin());
  const std::size_t padded = (length / kUnit + 1) * kUnit;
  const auto whole = reader->bytes(padded);
  if (reader->is_short()) return bad("a text that is not padded");
  for (const std::byte b : whole.subspan(length)) {
    if (b != std::byte{0}) return bad("a text that is padded with something");
  }
  *ret_text = as_text(whole.first(length));
  return Done{};
}

Status read_blob(PacketReader* reader, std::vector<std::byte>* ret_blob) {
  const std::uint32_t size = reader->u32();
  if (size > reader->left()) return bad("a blob that is longer than the packet");
  const auto bytes = reader->bytes(size);
  const auto padding = reader->bytes((kUnit - size % kUnit) % kUnit);
  if (reader->is_short() || std::any_of(padding.begin(), padding.end(), [](std::byte b) { return b != std::byte{0}; }))
    return bad("a blob that is not padded with zeros");
  ret_blob->assign(bytes.begin(), bytes.end());
  return Done{};
}

Status read_argument(char type, PacketReader* reader, std::span<const std::byte> packet, OscArgument* ret_argument) {
  switch (type) {
    case 'i':
      *ret_argument = reader->i32();
      return Done{};
    case 'f':
      *ret_argument = reader->f32();
      return Done{};
    case 'h':
      *ret_argument = reader->i64();
      return Done{};
    case 'd':
      *ret_argument = reader->f64();
      return Done{};
    case 't':
      *ret_argument = OscTime{reader->u64()};
      return Done{};
    case 'T':
    case 'F':
      *ret_argument = type == 'T';
      return Done{};
    case 'N':
    case 'I':
      *ret_argument = OscNothing{};
      return Done{};
    case 's':
      return read_text(reader, packet, &ret_argument->emplace<std::string>());
    case 'b':
      return read_blob(reader, &ret_argument->emplace<std::vector<std::byte>>());
    default:
      return bad(fmt::format("an argument of the type with the code {}", static_cast<int>(type)));
  }
}

Status read_message(std::span<const std::byte> packet, OscMessage* ret_message) {
  PacketReader reader(packet);
  TRY(read_text(&reader, packet, &ret_message->address));
  if (!ret_message->address.starts_with("/")) return bad("a message whose address does not begin with '/'");
  std::string types;
  TRY(read_text(&reader, packet, &types));
  if (!types.starts_with(",")) return bad("a message without types");
  for (const char type : std::string_view(types).substr(1)) {
    TRY(read_argument(type, &reader, packet, &ret_message->arguments.emplace_back()));
    if (reader.is_short()) return bad("arguments that end too early");
  }
  if (!reader.is_empty()) return bad("bytes after the last argument");
  return Done{};
}

Status read_packet(std::span<const std::byte> packet, int depth, std::vector<OscMessage>* ret_messages) {
  if (packet.empty() || packet.size() % kUnit != 0) return bad("its size is no multiple of four");
  if (packet.front() != std::byte{'#'}) {
    return read_message(packet, &ret_messages->emplace_back());
  }
  if (depth >= kMaxOscBundleDepth) return bad("bundles in bundles without end");
  PacketReader reader(packet);
  std::string head;
  TRY(read_text(&reader, packet, &head));
  if (head != kBundle) return bad("'#' and no bundle");
  reader.u64();  // Skips the time tag: messages take effect at once.
  while (!reader.is_short() && !reader.is_empty()) {
    const std::uint32_t size = reader.u32();
    const auto part = reader.bytes(size);
    if (!reader.is_short()) TRY(read_packet(part, depth + 1, ret_messages));
  }
  if (reader.is_short()) return bad("a bundle that ends too early");
  return Done{};
}

void write_text(PacketWriter* writer, std::string_view text) {
  CHECK(text.find('\0') == std::string_view::npos);
  writer->text(text);
  writer->text(std::string_view("\0", 1));
  writer->pad(kUnit);
}

struct TypeOf {
  char operator()(std::int32_t) const { return 'i'; }
  char operator()(float) const { return 'f'; }
  char operator()(const std::string&) const { return 's'; }
  char operator()(const std::vector<std::byte>&) const { return 'b'; }
  char operator()(std::int64_t) const { return 'h'; }
  char operator()(double) const { return 'd'; }
  char operator()(const OscTime&) const { return 't'; }
  char operator()(bool value) const { return value ? 'T' : 'F'; }
  char operator()(const OscNothing&) const { return 'N'; }
};

struct Put {
  PacketWriter& writer;
  void operator()(std::int32_t value) const { writer.i32(value); }
  void operator()(float value) const { writer.f32(value); }
  void operator()(const std::string& value) const { write_text(&writer, value); }
  void operator()(const std::vector<std::byte>& value) const {
    writer.u32(static_cast<std::uint32_t>(value.size()));
    writer.raw(value);
    writer.pad(kUnit);
  }
  void operator()(std::int64_t value) const { writer.i64(value); }
  void operator()(double value) const { writer.f64(value); }
  void operator()(const OscTime& value) const { writer.u64(value.ntp); }
  void operator()(bool) const {}
  void operator()(const OscNothing&) const {}
};

struct AsNumber {
  std::optional<double> operator()(std::int32_t value) const { return value; }
  std::optional<double> operator()(float value) const { return value; }
  std::optional<double> operator()(std::int64_t value) const { return static_cast<double>(value); }
  std::optional<double> operator()(double value) const { return value; }
  template <typename T>
  std::optional<double> operator()(const T&) const {
    return std::nullopt;
  }
};

}  // namespace

std::optional<double> OscMessage::number(std::size_t index) const {
  return index < arguments.size() ? std::visit(AsNumber{}, arguments[index]) : std::nullopt;
}

std::vector<std::byte> encode_osc(const OscMessage& message) {
  PacketWriter writer;
  write_text(&writer, message.address);
  std::string types = ",";
  for (const OscArgument& argument : message.arguments) types += std::visit(TypeOf{}, argument);
  write_text(&writer, types);
  for (const OscArgument& argument : message.arguments) std::visit(Put{writer}, argument);
  return writer.take();
}

Result<std::vector<OscMessage>> decode_osc(std::span<const std::byte> packet) {
  std::vector<OscMessage> messages;
  TRY(read_packet(packet, 0, &messages));
  return messages;
}

}  // namespace cyclorama::tracker
