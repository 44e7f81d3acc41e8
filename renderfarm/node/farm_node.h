// SPDX-License-Identifier: Apache-2.0
/// A node of the farm: dials the head, loads what it is told to, renders the blocks that it is given.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/node/block_renderer.h"
#include "renderfarm/node/film_store.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/scene_store.h"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace cyclorama {

struct FarmNodeOptions {
  std::string head;    ///< "[::1]:7402".
  std::string name{};  ///< Shown to people.
  int threads = 1;     ///< What the head's balance goes by: how many threads the renderer uses.
};

/// Serves one head at a time, for ever; never listens. Threads: `link` (dials, reads orders), `render` (loads and
/// renders, in the order of the orders; the renderer has threads of its own), and, while a stream is open, `send`
/// (encodes, writes).
///
///   dialling ──stream open──► serving ──stream ends──► dialling ...     scenes stay loaded throughout
///
/// A block whose stream ended is given up at once: the head has given it to another node. Thread-safe.
class FarmNode {
 public:
  /// Starts to dial. kInvalidArgument  the address is none.
  static Result<std::unique_ptr<FarmNode>> start(FarmNodeOptions options, SceneLoader loader);
  ~FarmNode();
  FarmNode(const FarmNode&) = delete;
  FarmNode& operator=(const FarmNode&) = delete;

  /// Ends the stream, gives up the block at hand and joins. A scene that is being loaded is finished first. Idempotent.
  void stop();

  /// One sentence for an operator: what it does now.
  [[nodiscard]] std::string state() const;
  [[nodiscard]] bool is_loading() const { return loading_; }
  /// False when a block is at work and no cell of it was finished since `since`: for the watchdog.
  [[nodiscard]] bool has_moved_since(TimePoint since) const;

 private:
  struct Command {
    std::shared_ptr<NodeLink> link;
    wire::NodeCommand message;
  };
  FarmNode(FarmNodeOptions options, std::shared_ptr<grpc::Channel> channel, SceneLoader loader);

  void run_link();
  Error serve(bool* ret_served);
  Status take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& message);
  void run_render();
  void load(NodeLink& link, const wire::LoadScene& order);
  void render(NodeLink& link, std::uint64_t block);
  RenderedBlock render_tiles(NodeLink& link, const BlockOrder& order);
  /// A tile of a picture at rest: adds to the sums that it has, or begins them anew. Empty when cancelled.
  RgbImage refine_tile(BlockRenderer& renderer, const wire::RenderBlock& block, const PanoramaView& view,
                       const PixelRect& rect, const std::function<bool()>& cancelled, RenderCost* ret_cost);
  void set_state(std::string sentence);

  const FarmNodeOptions options_;
  const std::shared_ptr<grpc::Channel> channel_;
  SceneStore scenes_;  ///< Render thread only.
  FilmStore films_;    ///< Render thread only.
  std::atomic<bool> loading_ = false;
  std::atomic<bool> rendering_ = false;
  std::atomic<Duration::rep> moved_at_{0};  ///< TimePoint's count: when a cell was last begun.

  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<Command> commands_;
  grpc::ClientContext* context_ = nullptr;  ///< Of the current stream, so that stop() can cancel it.
  std::shared_ptr<NodeLink> link_;          ///< Likewise.
  std::string state_ = "starting";

  std::thread render_thread_;
  std::thread link_thread_;
};

}  // namespace cyclorama
