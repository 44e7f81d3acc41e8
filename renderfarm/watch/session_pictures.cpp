// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/session_pictures.h"

#include <fmt/format.h>

#include <utility>

#include "common/image/jpeg.h"

namespace cyclorama::watch {

void SessionPictures::taken(std::uint64_t session, wire::SessionReply reply) {
  if (reply.has_opened()) {
    const std::lock_guard lock(mutex_);
    newest_.try_emplace(session);
    return;
  }
  Coming& coming = coming_[session];
  if (reply.has_begin()) {
    coming = {};
    coming.wanted = true;
    coming.picture.width_px = static_cast<int>(reply.begin().panorama().width_px());
    coming.picture.height_px = static_cast<int>(reply.begin().panorama().height_px());
  } else if (reply.has_tile() && coming.wanted) {
    reply.mutable_tile()->clear_depth();  // Only the pixels are shown.
    coming.bytes += reply.tile().jpeg().size();
    coming.picture.tiles.push_back(std::move(*reply.mutable_tile()));
    if (coming.bytes > kMaxBytes) coming = {};
  } else if (reply.has_end()) {
    Coming whole = std::exchange(coming, {});
    if (!whole.wanted || !reply.end().complete()) return;
    auto picture = std::make_shared<FramePicture>(std::move(whole.picture));
    {
      const std::lock_guard lock(mutex_);
      picture->serial = ++last_serial_;
      newest_[session] = std::move(picture);
    }
    changed_.notify_all();
  }
}

void SessionPictures::session_ended(std::uint64_t session) {
  coming_.erase(session);
  {
    const std::lock_guard lock(mutex_);
    newest_.erase(session);
  }
  changed_.notify_all();
}

void SessionPictures::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

std::shared_ptr<const FramePicture> SessionPictures::newest(std::uint64_t session, std::uint64_t after,
                                                            TimePoint deadline) const {
  std::unique_lock lock(mutex_);
  std::shared_ptr<const FramePicture> found;
  changed_.wait_until(lock, deadline, [&] {
    const auto entry = newest_.find(session);
    if (closed_ || entry == newest_.end()) return true;
    if (entry->second != nullptr && entry->second->serial > after) found = entry->second;
    return found != nullptr;
  });
  return found;
}

bool SessionPictures::is_open(std::uint64_t session) const {
  const std::lock_guard lock(mutex_);
  return !closed_ && newest_.contains(session);
}

Result<RgbImage> composed(const FramePicture& frame) {
  RgbImage picture(frame.width_px, frame.height_px);
  JpegDecoder decoder;
  for (const wire::Tile& tile : frame.tiles) {
    const auto width = static_cast<std::uint32_t>(frame.width_px);
    const auto height = static_cast<std::uint32_t>(frame.height_px);
    const bool inside = tile.width_px() <= width && tile.x_px() <= width - tile.width_px() &&
                        tile.height_px() <= height && tile.y_px() <= height - tile.height_px();
    if (!inside || tile.width_px() == 0 || tile.height_px() == 0) {
      return Error(ErrorCode::kBadData,
                   fmt::format("a tile at {}, {} is not in the picture", tile.x_px(), tile.y_px()));
    }
    TRY(decoder.decode_into(
        std::as_bytes(std::span(tile.jpeg())), picture.at(static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px())),
        static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()), picture.row_values()));
  }
  return picture;
}

RgbImage halved(const RgbImage& image) {
  if (image.width() < 2 || image.height() < 2) return image;
  RgbImage half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    const std::uint8_t* const upper = image.at(0, 2 * y);
    const std::uint8_t* const lower = image.at(0, 2 * y + 1);
    std::uint8_t* const row = half.at(0, y);
    for (std::size_t x = 0; x < static_cast<std::size_t>(half.width()); ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const int sum = upper[6 * x + c] + upper[6 * x + 3 + c] + lower[6 * x + c] + lower[6 * x + 3 + c] + 2;
        row[3 * x + c] = static_cast<std::uint8_t>(sum / 4);
      }
    }
  }
  return half;
}

}  // namespace cyclorama::watch
