// SPDX-License-Identifier: Apache-2.0
/// The queue that the node's threads share while one stream to a coordinator is open.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "common/base/clock.h"
#include "common/image/image.h"
#include "common/image/inverse_depth.h"
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/node/link_id.h"
#include "renderfarm/render/renderer.h"

namespace grpc {
class Channel;
}  // namespace grpc

namespace cyclorama::node {

/// Pixels to be encoded, and the depth of their cells of 4×4 pixels, which is empty unless the view requests it.
struct RenderedTile {
  std::uint64_t block = 0;
  std::uint64_t view_number = 0;
  PixelRect rect;
  RgbImage pixels;
  InverseDepthImage depth;
  JpegOptions options;
};
/// The end of a block, sent after its last tile.
struct RenderedBlock {
  std::uint64_t block = 0;
  render::RenderCost cost;
  std::string error{};
  double waited_seconds = 0.0;  ///< Time that the block waited while others were rendered.
};

/// The outgoing queue to one coordinator, one per stream. The sender takes the items that the workers push.
///
///   open ──finish()──► finishing: queued items are still sent ──close()──► closed: all work for it stops
///     └────────────────────────────────close()────────────────────────────────┘
///
/// Thread-safe.
class NodeLink {
 public:
  using Outgoing = std::variant<wire::NodeReport, RenderedTile, RenderedBlock>;

  /// `files` is the channel on which the coordinator distributes files; null if it distributes none. `threads` render
  /// and encode.
  explicit NodeLink(LinkId id, std::shared_ptr<grpc::Channel> files = nullptr, int threads = 1);
  [[nodiscard]] LinkId id() const { return id_; }
  [[nodiscard]] const std::shared_ptr<grpc::Channel>& files() const { return files_; }

  /// Queues an item; never waits. Does nothing once the link is finishing.
  void push(Outgoing item);
  /// Returns false while the queue is full: a slow encoder or network suspends rendering.
  [[nodiscard]] bool takes_tiles() const;
  /// Waits for an item. Returns nothing at the deadline, when the link is closed, and when it is finishing and its
  /// queue is empty.
  std::optional<Outgoing> pop(TimePoint deadline);

  void finish();
  void close();
  [[nodiscard]] bool is_finished() const;  ///< True once the link is finishing and its queue is empty.
  [[nodiscard]] bool is_closed() const { return closed_; }

 private:
  const LinkId id_;
  const std::shared_ptr<grpc::Channel> files_;
  const std::size_t max_outgoing_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Outgoing> outgoing_;
  bool finishing_ = false;
  std::atomic<bool> closed_ = false;  ///< Written under mutex_; read without it from the render threads.
};

}  // namespace cyclorama::node
