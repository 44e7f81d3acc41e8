// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/scene_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/base/text.h"
#include "common/wire/convert.h"

namespace cyclorama::coordinator {
namespace {

/// Time after which a node that failed to load a scene tries again, if a session requests it.
constexpr auto kRetryDelay = std::chrono::seconds(10);
constexpr std::size_t kMaxErrorBytes = 500;

bool is_same_scene(const wire::SceneDescription& a, const wire::SceneDescription& b) {
  return a.title() == b.title() && a.triangles_seen() == b.triangles_seen() &&
         a.triangles_stored() == b.triangles_stored();
}

}  // namespace

void SceneOrders::order_all(NodeId id, Node& node) {
  // Scenes in use come first; a later scene never replaces an earlier one.
  std::vector<FarmScene> order_of = catalogue_.all();
  std::set<std::string> keep = sessions_.scenes_in_use();
  std::stable_partition(order_of.begin(), order_of.end(),
                        [&](const FarmScene& scene) { return keep.contains(scene.name); });
  for (const FarmScene& scene : order_of) {
    keep.insert(scene.name);
    order(id, node, scene, keep);
  }
}

void SceneOrders::order(NodeId id, Node& node, const FarmScene& scene, const std::set<std::string>& keep) {
  if (!scene.is_ready()) return;  // read() orders the scene later.
  node.scenes[scene.name] = {};
  node.scenes[scene.name].asked_at = clock_.now();
  wire::NodeCommand command;
  command.mutable_load_scene()->set_scene(scene.name);
  if (scene.on_coordinator) {
    command.mutable_load_scene()->set_digest(scene.digest);
  } else {
    command.mutable_load_scene()->set_path(scene.path);
  }
  for (const std::string& name : keep) command.mutable_load_scene()->add_in_use(name);
  delegate_.to_node(id, command);
}

void SceneOrders::read(const std::string& scene, const std::string& digest) {
  const FarmScene& known = catalogue_.set_digest(scene, digest);
  for (auto& [id, node] : nodes_) {
    if (node.threads <= 0.0) continue;
    std::set<std::string> keep = sessions_.scenes_in_use();
    for (const auto& [name, ordered] : node.scenes) keep.insert(name);
    order(id, node, known, keep);
  }
}

void SceneOrders::order_anew(const std::string& scene) {
  for (auto& [id, node] : nodes_) {
    const auto known = node.scenes.find(scene);
    if (known == node.scenes.end()) continue;
    const bool is_dropped = known->second.state == Node::SceneState::kDropped;
    const bool has_failed = known->second.state == Node::SceneState::kFailed;
    if (is_dropped || (has_failed && clock_.now() - known->second.asked_at > kRetryDelay)) {
      order(id, node, catalogue_.at(scene), sessions_.scenes_in_use());
    }
  }
}

Status SceneOrders::dropped(Node& node, const wire::SceneDropped& dropped) {
  const auto known = node.scenes.find(dropped.scene());
  if (known == node.scenes.end()) {
    return broken(fmt::format("it dropped scene '{}', which it was never ordered to load", printable(dropped.scene())));
  }
  if (known->second.state == Node::SceneState::kLoaded) {
    known->second.state = Node::SceneState::kDropped;
    lights_.follow(dropped.scene());
    delegate_.notice(fmt::format("{} dropped scene '{}': its memory is short", title_of(node), dropped.scene()),
                     {.node = node.name});
  }
  return Done{};
}

Status SceneOrders::loaded(Node& node, const wire::SceneLoaded& loaded) {
  const auto asked = node.scenes.find(loaded.scene());
  if (asked == node.scenes.end() || asked->second.state != Node::SceneState::kLoading) {
    return broken(fmt::format("it loaded scene '{}', which nobody requested", printable(loaded.scene())));
  }
  if (!loaded.error().empty()) {
    asked->second.state = Node::SceneState::kFailed;
    asked->second.error = printable(loaded.error(), kMaxErrorBytes);
    delegate_.notice(fmt::format("{} cannot load scene '{}': {}", title_of(node), loaded.scene(), asked->second.error),
                     {.node = node.name, .is_trouble = true});
    return Done{};
  }
  TRY(validate(loaded.description()));
  if (loaded.description().name() != loaded.scene()) return broken("a scene's description has another name");
  asked->second.memory_bytes = loaded.memory_bytes();
  if (nodes_.count_with(loaded.scene()) == 0) {
    TRY(catalogue_.learn(loaded));
  } else if (!is_same_scene(*catalogue_.description(loaded.scene()), loaded.description())) {
    // Without this check, a picture could be composed of two different scenes.
    asked->second.state = Node::SceneState::kFailed;
    asked->second.error = "its copy differs from the other nodes'";
    delegate_.notice(
        fmt::format("{} has another scene '{}' than the other nodes: copy it again; it is not used until then",
                    title_of(node), loaded.scene()),
        {.node = node.name, .is_trouble = true});
    return Done{};
  }
  if (!loaded.note().empty()) {
    delegate_.notice(fmt::format("{}, scene '{}': {}", title_of(node), loaded.scene(), printable(loaded.note())),
                     {.node = node.name});
  }
  if (loaded.has_light()) TRY(SceneLights::add(loaded.light(), &asked->second));
  asked->second.can_compute_light = loaded.can_compute_light();
  asked->second.state = Node::SceneState::kLoaded;
  asked->second.speed = speeds_.relative(loaded);
  delegate_.notice(fmt::format("{} has scene '{}': {:.1f} M triangles, {:.2f} GiB, loaded in {:.1f} s", title_of(node),
                               loaded.scene(), 1e-6 * static_cast<double>(loaded.description().triangles_seen()),
                               static_cast<double>(loaded.memory_bytes()) / (1 << 30), loaded.load_seconds()),
                   {.node = node.name});
  lights_.follow(loaded.scene());
  return Done{};
}

Error SceneOrders::unavailable_reason(const std::string& scene) const {
  if (!catalogue_.at(scene).is_ready()) {
    return Error(ErrorCode::kUnavailable, fmt::format("scene '{}': the coordinator is still reading its files", scene));
  }
  std::size_t loading = 0;
  std::string failure;
  for (const auto& [id, node] : nodes_) {
    const auto found = node.scenes.find(scene);
    if (found == node.scenes.end()) continue;
    if (found->second.state == Node::SceneState::kLoading) ++loading;
    if (found->second.state == Node::SceneState::kFailed)
      failure = fmt::format("'{}': {}", node.name, found->second.error);
  }
  std::string why = "no node is connected; start cyclorama-node on the render hosts";
  if (!nodes_.empty()) why = fmt::format("none of {} nodes has it", nodes_.size());
  if (!failure.empty()) why = fmt::format("no node could load it; node {}", failure);
  if (loading > 0) why = fmt::format("{} of {} nodes are loading it; it will be ready soon", loading, nodes_.size());
  return Error(ErrorCode::kUnavailable, fmt::format("scene '{}': {}", scene, why));
}

}  // namespace cyclorama::coordinator
