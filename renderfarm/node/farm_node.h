// SPDX-License-Identifier: Apache-2.0
/// A node of the farm: dials the coordinators, loads what it is told to, renders the blocks that it is given.
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

struct FarmNodeOptions {
  std::vector<std::string> coordinators{};  ///< "[::1]:7402"; all are served at once.
  std::string name{};                       ///< Shown to people.
  int threads = 1;  ///< What the coordinator's balance goes by: how many threads the renderer uses.
  std::uint64_t memory_limit_bytes = 0;  ///< What scenes and films may take together; 0: scenes are not limited.
  scene_distribution::SceneCacheOptions
      cache{};                    ///< For scenes that coordinators hand out; without a folder it takes none.
  std::optional<TlsFiles> tls{};  ///< Nothing: not encrypted, for coordinators on this machine.
};

/// Serves its coordinators, for ever; never listens. Threads: `render`, `load`, and for each coordinator `link` and `send`
/// (coordinator_connection.h); the renderer has threads of its own. A block whose stream ended is given up at once: the coordinator has
/// given it to another node. Scenes stay loaded throughout, and are shared by the coordinators. Thread-safe.
class FarmNode {
 public:
  /// Starts to dial. kInvalidArgument  an address is none, or there are none.     With `tls` also as
  /// check(TlsFiles).
  static Result<std::unique_ptr<FarmNode>> start(const FarmNodeOptions& options, SceneLoader loader);
  ~FarmNode();
  FarmNode(const FarmNode&) = delete;
  FarmNode& operator=(const FarmNode&) = delete;

  /// Tells the coordinators that it wants no new blocks, renders those that it has, and ends its streams; what is not done
  /// after `limit` is given up. To be followed by stop().
  void drain(Duration limit);
  /// Ends the streams, gives up the block at hand and joins. A scene that is being loaded is finished first.
  /// Idempotent.
  void stop();

  /// In a few sentences for an operator: what it does now.
  [[nodiscard]] std::string state() const;
  [[nodiscard]] bool is_loading() const { return controller_.loads().is_loading(); }
  /// False when a block is at work and no cell of it was begun since `since`: for the watchdog.
  [[nodiscard]] bool has_moved_since(TimePoint since) const { return controller_.renders().has_moved_since(since); }

 private:
  FarmNode(const FarmNodeOptions& options, SceneLoader loader);

  NodeController controller_;
  std::thread render_thread_;
  std::thread load_thread_;
  std::vector<std::unique_ptr<CoordinatorConnection>> coordinators_;  ///< Not changed after start().
};

}  // namespace cyclorama::node
