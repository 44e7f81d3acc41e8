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

namespace cyclorama {

/// One whole frame as the museum got it.
struct FramePicture {
  std::uint64_t serial = 0;  ///< Grows with each picture of any visit.
  int width_px = 0;
  int height_px = 0;
  std::vector<wire::Tile> tiles{};
};

/// The newest whole frame of each visit, for the operator's eyes. The head's loop gives it each message that a museum
/// has taken, bytes and all, so nothing is copied and nothing is decoded there; who watches does that on a thread of
/// their own. Memory: of each visit the newest frame and the one that is coming, each of at most kMostBytes.
/// Thread-safe; the calls of one visit's messages come from one thread, in order.
class VisitPictures {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;

  /// A message is on its way to the museum. A frame that is larger than kMostBytes or not complete is left out.
  void taken(std::uint64_t visit, wire::VisitReply reply);
  void visit_ended(std::uint64_t visit);
  /// Nobody waits in vain from now on.
  void close();

  /// The newest one whose serial is beyond `after`; waits for it until `deadline`. Null when there is none.
  [[nodiscard]] std::shared_ptr<const FramePicture> newest(std::uint64_t visit, std::uint64_t after,
                                                           TimePoint deadline) const;
  /// False once the visit has ended, or the farm has: its watchers may go.
  [[nodiscard]] bool is_open(std::uint64_t visit) const;

 private:
  struct Coming {
    FramePicture picture{};
    std::size_t bytes = 0;
    bool wanted = false;
  };
  std::map<std::uint64_t, Coming> coming_;  ///< The loop's alone.

  mutable std::mutex mutex_;  ///< Guards the following.
  mutable std::condition_variable changed_;
  std::map<std::uint64_t, std::shared_ptr<const FramePicture>> newest_;  ///< Null: the visit has no frame yet.
  std::uint64_t last_serial_ = 0;
  bool closed_ = false;
};

/// Its tiles decoded, side by side. kBadData  a tile that is no JPEG, or lies outside the picture.
Result<RgbImage> composed(const FramePicture& frame);

/// Half as wide and high, rounded down; each pixel the mean of four. Smaller than 2x2: as it is.
[[nodiscard]] RgbImage halved(const RgbImage& image);

}  // namespace cyclorama
