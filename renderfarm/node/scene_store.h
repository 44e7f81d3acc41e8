// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/wire/nodes.pb.h"
#include "renderfarm/node/block_renderer.h"

namespace cyclorama {

/// The scenes that a node has in memory. They stay when the head goes away, so that a new head need not wait.
/// Thread-bound.
class SceneStore {
 public:
  explicit SceneStore(SceneLoader loader) : loader_(std::move(loader)) {}

  /// Loads, or finds that it is loaded from that very path, and says what the head must hear. A load that fails for
  /// whatever reason, memory included, is an answer with `error`; it is tried again when it is asked for again.
  wire::SceneLoaded load(const wire::LoadScene& order, const std::function<void(double)>& progress);
  /// Null when it is not loaded.
  [[nodiscard]] BlockRenderer* find(const std::string& scene) const;

 private:
  struct Loaded {
    std::string path;
    std::unique_ptr<BlockRenderer> renderer;
    wire::SceneLoaded answer;
  };
  Result<std::unique_ptr<BlockRenderer>> load_guarded(const std::string& path,
                                                      const std::function<void(double)>& progress);

  const SceneLoader loader_;
  std::map<std::string, Loaded> scenes_;
};

}  // namespace cyclorama
