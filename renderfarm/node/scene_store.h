// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/nodes.pb.h"
#include "renderfarm/node/block_renderer.h"
#include "renderfarm/node/link_id.h"

namespace cyclorama::node {

/// The scenes that a node has in memory, each once, whichever coordinators know it and however they call it. They stay when a
/// coordinator goes away, so that it need not wait when it comes back. When memory is short, the scene that was used longest
/// ago leaves, but none that a coordinator said is in use and none that blocks wait for.
/// Thread-safe; one load() at a time, which holds nobody else up.
class SceneStore {
 public:
  /// A scene as one coordinator calls it.
  struct Name {
    LinkId link = 0;
    std::string scene;
    friend auto operator<=>(const Name&, const Name&) = default;
  };

  /// `most_bytes`: what the scenes may take together; 0: not limited. While a scene is being loaded it cannot be known,
  /// so for that time they may take more.
  explicit SceneStore(SceneLoader loader, std::uint64_t max_bytes = 0)
      : loader_(std::move(loader)), max_bytes_(max_bytes) {}

  /// Loads from `path` what the coordinator calls order.scene(), or finds that it is loaded from there, and says what the coordinator
  /// must hear. A load that fails for whatever reason, memory included, is an answer with `error`; it is tried again
  /// when it is asked for again. `ret_left`: what had to leave; their coordinators must hear of it, too.
  wire::SceneLoaded load(LinkId link, const wire::LoadScene& order, const std::string& path,
                         const std::function<void(double)>& progress, std::vector<Name>* ret_left);
  /// Whether what is at `path` is loaded.
  [[nodiscard]] bool has(const std::string& path) const;
  /// Null when it is not loaded. It stays as long as somebody holds it.
  [[nodiscard]] std::shared_ptr<BlockRenderer> find(LinkId link, const std::string& scene);
  /// The coordinator has gone: what it calls its scenes is forgotten, not they.
  void forget_link(LinkId link);

 private:
  struct Loaded {
    std::shared_ptr<BlockRenderer> renderer;
    wire::SceneLoaded answer;
    std::uint64_t used = 0;  ///< Grows: the smallest was used longest ago.
  };
  using Scenes = std::map<std::string, Loaded>;  ///< By path.
  /// Freeing a large scene takes long: it is done without the lock.
  struct Leaving {
    std::vector<Name> names{};
    std::vector<std::shared_ptr<BlockRenderer>> renderers{};
  };

  Result<std::unique_ptr<BlockRenderer>> load_guarded(const std::string& path,
                                                      const std::function<void(double)>& progress);
  Result<Loaded> loaded_from(const std::string& name, const std::string& path,
                             const std::function<void(double)>& progress);
  // With mutex_ held:
  void rename(const Name& name, Leaving* ret_leaving);
  bool make_room(std::uint64_t bytes, Leaving* ret_leaving);
  void drop(Scenes::iterator scene, Leaving* ret_leaving);
  [[nodiscard]] bool may_leave(const Scenes::value_type& scene) const;
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t bytes_in_use() const;

  const SceneLoader loader_;
  const std::uint64_t max_bytes_;

  mutable std::mutex mutex_;  ///< Guards the following.
  Scenes scenes_;
  std::map<Name, std::string> paths_;
  std::map<LinkId, std::set<std::string>> in_use_;
  std::uint64_t uses_ = 0;
};

}  // namespace cyclorama::node
