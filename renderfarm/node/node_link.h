// SPDX-License-Identifier: Apache-2.0
/// What the node's threads share while one stream to the head is open.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "common/image/image.h"
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama {

/// A block that the head wants, until it has had its `end`.
struct BlockOrder {
  wire::RenderBlock block;
  std::atomic<bool> cancelled = false;
};

/// Pixels on their way to the encoder.
struct RenderedTile {
  std::uint64_t block = 0;
  std::uint64_t view_number = 0;
  PixelRect rect;
  RgbImage pixels;
  JpegOptions options;
};
/// After the last tile of a block.
struct RenderedBlock {
  std::uint64_t block = 0;
  RenderCost cost;
  std::string error{};
};

/// One per stream, shared by the reader, the render thread and the sender; when the stream ends it is closed, and
/// whoever works for it stops. Thread-safe.
class NodeLink {
 public:
  using Outgoing = std::variant<wire::NodeReport, RenderedTile, RenderedBlock>;

  /// False when the number is in use or too many blocks wait: the head is broken.
  bool take_order(const wire::RenderBlock& block);
  void cancel(std::uint64_t block);
  /// Null for an unknown number.
  [[nodiscard]] std::shared_ptr<const BlockOrder> order(std::uint64_t block) const;
  void forget(std::uint64_t block);

  /// Waits while a few tiles are on their way already; false once the link is closed.
  bool push(Outgoing item);
  /// Waits for an item; nothing once the link is closed.
  std::optional<Outgoing> pop();
  void close();
  [[nodiscard]] bool is_closed() const { return closed_; }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Outgoing> outgoing_;
  std::map<std::uint64_t, std::shared_ptr<BlockOrder>> orders_;
  std::atomic<bool> closed_ = false;  ///< Written under mutex_; read without it from the render threads.
};

}  // namespace cyclorama
