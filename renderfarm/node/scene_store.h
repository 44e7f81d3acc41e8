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
#include "renderfarm/node/light_files.h"
#include "renderfarm/node/link_id.h"

namespace cyclorama::node {

/// The scenes in a node's memory. Each is loaded once, even if several coordinators use it or it has several names.
/// Scenes stay when a coordinator disconnects, so that it need not wait when it returns. If memory is short, the least
/// recently used scene is unloaded, unless a coordinator reported it as in use or blocks wait for it. Thread-safe; only
/// one load() may run at a time, which blocks no other call.
class SceneStore {
 public:
  /// A coordinator's name for a scene.
  struct Name {
    LinkId link = 0;
    std::string scene;
    friend auto operator<=>(const Name&, const Name&) = default;
  };

  /// `max_bytes` limits the scenes together; 0: no limit. The size of a scene is unknown while it is being loaded, so
  /// the limit may be exceeded meanwhile. `light` locates the light that this node computed or fetched;
  /// `computes_light` states whether the node can compute light.
  explicit SceneStore(SceneLoader loader, std::uint64_t max_bytes = 0, LightFiles light = LightFiles(""),
                      bool computes_light = false)
      : loader_(std::move(loader)), max_bytes_(max_bytes), light_(std::move(light)), computes_light_(computes_light) {}

  /// Loads the scene at `path` under the name order.scene(), unless it is loaded already, and returns the reply to the
  /// coordinator. Any failure, including lack of memory, becomes a reply with `error`; a repeated order tries again.
  /// `ret_left` receives the names of unloaded scenes, which must be reported to their coordinators, too.
  wire::SceneLoaded load(LinkId link, const wire::LoadScene& order, const std::string& path,
                         const std::function<void(double)>& progress, std::vector<Name>* ret_left);
  /// Returns true if the scene at `path` is loaded.
  [[nodiscard]] bool has(const std::string& path) const;
  /// Returns the path of a coordinator's scene; empty if it is not loaded.
  [[nodiscard]] std::string path_of(LinkId link, const std::string& scene) const;
  /// Returns null if the scene at `path` is not loaded.
  [[nodiscard]] std::shared_ptr<BlockRenderer> at_path(const std::string& path) const;
  /// Returns the names of the scene at `path`, by coordinator.
  [[nodiscard]] std::vector<Name> names_of(const std::string& path) const;
  /// Records that the scene at `path` has this light, and returns the reports of it, or of why it has none, to each
  /// coordinator that has the scene.
  [[nodiscard]] std::vector<std::pair<LinkId, wire::SceneLight>> light_reports(const std::string& path,
                                                                               const Result<VersionedLight>& light);
  /// Returns null if the scene is not loaded. The scene stays in memory while the pointer is held.
  [[nodiscard]] std::shared_ptr<BlockRenderer> find(LinkId link, const std::string& scene);
  /// Forgets the names of a coordinator that has disconnected; the scenes stay.
  void forget_link(LinkId link);

 private:
  struct Loaded {
    std::shared_ptr<BlockRenderer> renderer;
    wire::SceneLoaded answer;
    std::uint64_t used = 0;  ///< Use counter; the smallest is the least recently used.
  };
  using Scenes = std::map<std::string, Loaded>;  ///< Scenes by path.
  /// Scenes to be freed after mutex_ is released, because freeing a large scene takes long.
  struct Leaving {
    std::vector<Name> names{};
    std::vector<std::shared_ptr<BlockRenderer>> renderers{};
  };

  Result<std::unique_ptr<BlockRenderer>> load_guarded(const std::string& path,
                                                      const std::function<void(double)>& progress);
  Result<Loaded> loaded_from(const std::string& name, const std::string& path,
                             const std::function<void(double)>& progress);
  /// Reads the light that this node computed or fetched earlier, if any. Errors: those of BlockRenderer::add_light().
  Status read_kept_light(const std::string& path, BlockRenderer& renderer) const;
  [[nodiscard]] static wire::SceneLoaded answer_for(const Loaded& loaded, const std::string& name);
  // With mutex_ held:
  void rename(const Name& name, Leaving* ret_leaving);
  bool make_room(std::uint64_t bytes, Leaving* ret_leaving);
  void drop(Scenes::iterator scene, Leaving* ret_leaving);
  [[nodiscard]] bool may_leave(const Scenes::value_type& scene) const;
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t bytes_in_use() const;

  const SceneLoader loader_;
  const std::uint64_t max_bytes_;
  const LightFiles light_;
  const bool computes_light_;

  mutable std::mutex mutex_;  ///< Guards the following.
  Scenes scenes_;
  std::map<Name, std::string> paths_;
  std::map<LinkId, std::set<std::string>> in_use_;
  std::uint64_t uses_ = 0;
};

}  // namespace cyclorama::node
