// SPDX-License-Identifier: Apache-2.0
/// A node of the farm: connects to the coordinators, loads the scenes and renders the blocks that they order.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/tls.h"
#include "renderfarm/node/block_renderer.h"
#include "renderfarm/node/node_controller.h"

namespace cyclorama::node {

class CoordinatorConnection;

/// Nice value of the threads that render. They use all processors, and must delay neither orders nor tiles.
inline constexpr int kRaysGiveWay = 5;

struct FarmNodeOptions {
  std::vector<std::string> coordinators{};  ///< Addresses such as "[::1]:7402"; all are served at once.
  std::string name{};                       ///< Name shown to the operator.
  int threads = 1;                          ///< Threads of the renderer; the coordinator balances by this number.
  /// The threads, which the loaded scenes use, too.
  std::shared_ptr<render::Crew> crew = std::make_shared<render::Crew>(1);
  std::uint64_t memory_limit_bytes = 0;     ///< Limit for scenes and films together; 0: scenes are not limited.
  /// Cache for distributed scenes. A node without a cache folder accepts no distributed scenes.
  scene_distribution::SceneCacheOptions cache{};
  bool computes_light = true;     ///< Computes the light of scenes ahead while there is nothing to render.
  std::optional<TlsFiles> tls{};  ///< Empty: unencrypted, for coordinators on this machine.
};

/// Serves its coordinators until stopped; never listens. Threads: `render` for each lane (block_lanes.h), the crew's,
/// `load`, `light`, and for each coordinator `link` and `send` (coordinator_connection.h). A block whose stream ended is abandoned at
/// once, because the coordinator has reassigned it. Scenes stay loaded throughout, and the coordinators share them.
/// Thread-safe.
class FarmNode {
 public:
  /// Starts to connect. Without `light`, the node computes no light. Errors: kInvalidArgument if an address is
  /// malformed or there are none; with `tls`, also those of check(TlsFiles).
  static Result<std::unique_ptr<FarmNode>> start(const FarmNodeOptions& options, SceneLoader loader,
                                                 LightStarter light = nullptr);
  ~FarmNode();
  FarmNode(const FarmNode&) = delete;
  FarmNode& operator=(const FarmNode&) = delete;

  /// Reports to the coordinators that the node is draining, renders the blocks that it has, and ends its streams.
  /// Blocks that are unfinished after `limit` are abandoned. The caller must call stop() afterwards.
  void drain(Duration limit);
  /// Ends the streams, abandons the current block and joins the threads. If a scene is being loaded, waits until it is.
  /// Idempotent.
  void stop();

  /// Returns a few sentences on the current state for the operator.
  [[nodiscard]] std::string state() const;
  [[nodiscard]] bool is_loading() const { return controller_.loads().is_loading(); }
  /// Returns false if a block is being rendered and none of its cells was begun since `since`. Used by the watchdog.
  [[nodiscard]] bool has_moved_since(TimePoint since) const { return controller_.renders().has_moved_since(since); }

 private:
  FarmNode(const FarmNodeOptions& options, SceneLoader loader, LightStarter light);

  NodeController controller_;
  std::vector<std::thread> render_threads_;  ///< One for each lane.
  std::thread load_thread_;
  std::thread light_thread_;
  std::vector<std::unique_ptr<CoordinatorConnection>> coordinators_;  ///< Not changed after start().
};

}  // namespace cyclorama::node
