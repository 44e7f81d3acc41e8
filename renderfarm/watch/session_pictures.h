// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/image/image.h"
#include "common/wire/farm.pb.h"

namespace cyclorama::watch {

/// One complete frame, as the museum received it.
struct FramePicture {
  std::uint64_t serial = 0;  ///< Increases with each picture of any session.
  int width_px = 0;
  int height_px = 0;
  std::vector<wire::Tile> tiles{};
};

/// Keeps the newest complete frame of each session for the operator. The coordinator's loop moves each message that a
/// museum has received into this object, so it neither copies nor decodes; watchers decode on their own threads.
/// Memory: the newest frame and the next one of each session, each at most kMaxBytes. Thread-safe; the messages of one
/// session must come from one thread, in order.
class SessionPictures {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{32} << 20;

  /// Adds a message that was sent to the museum. Frames that exceed kMaxBytes or are incomplete are omitted.
  void taken(std::uint64_t session, wire::SessionReply reply);
  void session_ended(std::uint64_t session);
  /// Ends all present and future waits.
  void close();

  /// Returns the newest frame with a serial above `after`, for which it waits until `deadline`. Null if there is none.
  [[nodiscard]] std::shared_ptr<const FramePicture> newest(std::uint64_t session, std::uint64_t after,
                                                           TimePoint deadline) const;
  /// Returns false once the session has ended or close() was called, so that watchers can stop.
  [[nodiscard]] bool is_open(std::uint64_t session) const;

 private:
  struct Coming {
    FramePicture picture{};
    std::size_t bytes = 0;
    bool wanted = false;
  };
  std::map<std::uint64_t, Coming> coming_;  ///< Bound to the coordinator's loop.

  mutable std::mutex mutex_;  ///< Guards the following.
  mutable std::condition_variable changed_;
  /// Null while the session has no complete frame.
  std::map<std::uint64_t, std::shared_ptr<const FramePicture>> newest_;
  std::uint64_t last_serial_ = 0;
  bool closed_ = false;
};

/// Decodes the tiles into one picture. Errors: kBadData if a tile is no JPEG or lies outside the picture.
Result<RgbImage> composed(const FramePicture& frame);

/// Returns a picture of half the width and height, rounded down; each pixel is the mean of four. Returns a picture
/// below 2×2 unchanged.
[[nodiscard]] RgbImage halved(const RgbImage& image);

}  // namespace cyclorama::watch
