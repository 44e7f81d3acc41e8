// SPDX-License-Identifier: Apache-2.0
/// What the node's threads share while one stream to a coordinator is open.
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
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/node/link_id.h"
#include "renderfarm/render/renderer.h"

namespace grpc {
class Channel;
}  // namespace grpc

namespace cyclorama::node {

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
  render::RenderCost cost;
  std::string error{};
  double waited_seconds = 0.0;  ///< For rays of other blocks.
};

/// What is on its way to one coordinator. One per stream; the sender takes what the others push.
///
///   open ──finish()──► finishing: what is there is still sent ──close()──► closed: all who work for it stop
///     └───────────────────────────────close()───────────────────────────────┘
///
/// Thread-safe.
class NodeLink {
 public:
  using Outgoing = std::variant<wire::NodeReport, RenderedTile, RenderedBlock>;

  /// `files` is where the coordinator hands files out; null: nowhere.
  explicit NodeLink(LinkId id, std::shared_ptr<grpc::Channel> files = nullptr) : id_(id), files_(std::move(files)) {}
  [[nodiscard]] LinkId id() const { return id_; }
  [[nodiscard]] const std::shared_ptr<grpc::Channel>& files() const { return files_; }

  /// Never waits; nothing happens once the link finishes.
  void push(Outgoing item);
  /// False while a few tiles are on their way already: an encoder or a network that does not keep up stops the rays.
  [[nodiscard]] bool takes_tiles() const;
  /// Waits for an item; nothing at the deadline, when the link is closed, and when it finishes and all was taken.
  std::optional<Outgoing> pop(TimePoint deadline);

  void finish();
  void close();
  [[nodiscard]] bool is_finished() const;  ///< All was taken, and no more will come.
  [[nodiscard]] bool is_closed() const { return closed_; }

 private:
  const LinkId id_;
  const std::shared_ptr<grpc::Channel> files_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Outgoing> outgoing_;
  bool finishing_ = false;
  std::atomic<bool> closed_ = false;  ///< Written under mutex_; read without it from the render threads.
};

}  // namespace cyclorama::node
