// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/kept_picture.h"

#include <cstring>
#include <optional>

#include "common/wire/convert.h"

namespace cyclorama::tour {
namespace {

constexpr std::string_view kTitle = "cyclorama-kept 1\n";
constexpr std::size_t kMaxTiles = 65536;

void add(std::string* bytes, std::uint64_t number) {
  for (int shift = 0; shift < 64; shift += 8) bytes->push_back(static_cast<char>((number >> shift) & 0xff));
}

void add(std::string* bytes, const google::protobuf::MessageLite& message) {
  const std::string text = message.SerializeAsString();
  add(bytes, std::uint64_t{text.size()});
  *bytes += text;
}

std::string finished(std::string bytes) {
  add(&bytes, checksum_of(bytes));
  return bytes;
}

Error damaged(const char* what) { return Error(ErrorCode::kBadData, std::string("a kept file ") + what); }

/// Reads the messages of a file whose checksum is right, one after another.
class Messages {
 public:
  static Result<Messages> of(std::string_view bytes) {
    if (bytes.size() < kTitle.size() + sizeof(std::uint64_t) || !bytes.starts_with(kTitle))
      return damaged("does not begin with its title");
    const std::string_view content = bytes.substr(0, bytes.size() - sizeof(std::uint64_t));
    Messages end(bytes.substr(content.size()));
    if (end.number() != checksum_of(content)) return damaged("is damaged: its checksum is another");
    return Messages(content.substr(kTitle.size()));
  }
  [[nodiscard]] bool is_empty() const { return left_.empty(); }
  template <typename Message>
  Result<Message> next() {
    const std::optional<std::uint64_t> size = number();
    Message message;
    if (!size || *size > left_.size() || !message.ParseFromArray(left_.data(), static_cast<int>(*size)))
      return damaged("has a message that cannot be read");
    left_.remove_prefix(*size);
    return message;
  }

 private:
  explicit Messages(std::string_view left) : left_(left) {}
  std::optional<std::uint64_t> number() {
    if (left_.size() < sizeof(std::uint64_t)) return std::nullopt;
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < sizeof number; ++i)
      number |= std::uint64_t{static_cast<unsigned char>(left_[i])} << (8 * i);
    left_.remove_prefix(sizeof number);
    return number;
  }
  std::string_view left_;
};

}  // namespace

std::uint64_t checksum_of(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return sum;
}

std::string to_bytes(const KeptPicture& picture) {
  std::string bytes(kTitle);
  add(&bytes, picture.view);
  add(&bytes, picture.end);
  for (const wire::Tile& tile : picture.tiles) add(&bytes, tile);
  return finished(std::move(bytes));
}

Result<KeptPicture> parse_kept_picture(std::string_view bytes) {
  TRY_ASSIGN(Messages messages, Messages::of(bytes));
  KeptPicture picture;
  TRY_ASSIGN(picture.view, messages.next<wire::View>());
  TRY_ASSIGN(picture.end, messages.next<wire::FrameEnd>());
  TRY(validate(picture.view));
  const Projection projection = *from_wire(picture.view.panorama());
  while (!messages.is_empty()) {
    if (picture.tiles.size() >= kMaxTiles) return damaged("has too many tiles");
    TRY_ASSIGN(wire::Tile tile, messages.next<wire::Tile>());
    TRY(validate(tile, projection.width_px(), projection.height_px()));
    picture.tiles.push_back(std::move(tile));
  }
  if (!picture.end.complete() || picture.end.tiles() != picture.tiles.size()) return damaged("is no complete picture");
  return picture;
}

std::string to_bytes(const KeptVisit& visit) {
  std::string bytes(kTitle);
  add(&bytes, visit.scene);
  add(&bytes, visit.wanted);
  return finished(std::move(bytes));
}

Result<KeptVisit> parse_kept_visit(std::string_view bytes) {
  TRY_ASSIGN(Messages messages, Messages::of(bytes));
  KeptVisit visit;
  TRY_ASSIGN(visit.scene, messages.next<wire::SceneDescription>());
  TRY_ASSIGN(visit.wanted, messages.next<wire::Panorama>());
  TRY(validate(visit.scene));
  TRY(from_wire(visit.wanted));
  return visit;
}

}  // namespace cyclorama::tour
