// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/scene_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::coordinator {
namespace {

/// Time after which new light is used even if some nodes lack it; they render no frames with it until they have fetched
/// it.
constexpr Duration kSwitchTimeout = std::chrono::seconds(20);
/// If a node has not sent its light within this time, another node is ordered to send it.
constexpr Duration kSendTimeout = std::chrono::seconds(60);
/// If a node has not fetched its light within this time, it is ordered again to fetch it.
constexpr Duration kOfferTimeout = std::chrono::minutes(1);
/// If no node that got the order to compute light has reported a stage by then, all get it once more. It covers the
/// time to read a scene and to build its BVH.
constexpr Duration kComputeTimeout = std::chrono::minutes(2);

}  // namespace

Status SceneLights::add(const wire::LightVersion& light, Node::LoadedScene* scene) {
  if (!scene_distribution::is_sha256(light.version())) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("its light has version '{}', which is none", printable(light.version())));
  }
  std::erase_if(scene->light, [&](const wire::LightVersion& known) { return known.version() == light.version(); });
  scene->light.push_front(light);
  if (scene->light.size() > wire::kKeptLightVersions) scene->light.pop_back();
  return Done{};
}

Status SceneLights::light_reported(NodeId id, Node& node, const wire::SceneLight& report) {
  const auto known = node.scenes.find(report.scene());
  if (known == node.scenes.end()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("it reports light of scene '{}', which nobody requested", printable(report.scene())));
  }
  SceneLightState& light = lights_[report.scene()];
  const bool has_computed = light.computing.erase(id) > 0;
  light.board.leave(id);
  if (report.error().empty()) {
    TRY(add(report.light(), &known->second));
  } else {
    constexpr std::size_t kMaxErrorBytes = 500;
    bool& has_failed = has_computed ? known->second.has_failed_to_compute : known->second.has_failed_to_use;
    if (!std::exchange(has_failed, true)) {
      delegate_.notice(fmt::format("{}, scene '{}': {}, so paths are traced: {}", title_of(node), report.scene(),
                                   has_computed ? "its light could not be computed ahead" : "its light cannot be used",
                                   printable(report.error(), kMaxErrorBytes)),
                       {.node = node.name});
    }
  }
  follow(report.scene());
  return Done{};
}

Status SceneLights::pieces_reported(NodeId id, Node& node, const wire::LightPieces& report) {
  const auto light = lights_.find(report.scene());
  // It may have got the order from a coordinator before this one, or the light has come meanwhile.
  if (light == lights_.end() || !light->second.computing.contains(id)) return Done{};
  const bool is_first = report.stage().number() == 0;
  TRY_ASSIGN(const bool takes_part, light->second.board.report(id, report));
  if (!takes_part && is_first) {
    delegate_.notice(fmt::format("{} computes the light of scene '{}' otherwise than the nodes before it, such as "
                                 "with another processor or program: it takes no part",
                                 title_of(node), report.scene()),
                     {.node = node.name});
  }
  follow(report.scene());
  return Done{};
}

void SceneLights::stored(const std::string& version) {
  for (auto& [scene, light] : lights_) {
    light.board.stored(version);
    order_pieces(scene, light);
    if (light.target.version() != version) continue;
    if (!light.stored_at) light.stored_at = clock_.now();
    follow(scene);
  }
}

void SceneLights::follow(const std::string& scene) {
  const auto [known, is_new] = lights_.try_emplace(scene);
  SceneLightState& light = known->second;
  if (is_new) light.gathering_since = clock_.now();
  choose(scene, light);
  spread(scene, light);
  switch_to_target(scene, light);
  order(scene, light);
}

void SceneLights::choose(const std::string& scene, SceneLightState& light) {
  if (!light.target.version().empty() &&
      (light.stored_at || nodes_.count_with_light(scene, light.target.version()) > 0))
    return;
  // Chooses the version that most nodes have; of several, the first by name, so that a restarted coordinator chooses
  // the same.
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> counts;
  for (const auto& [id, node] : nodes_) {
    if (!node.has(scene)) continue;
    for (const wire::LightVersion& version : node.scenes.at(scene).light) {
      auto& [count, bytes] = counts[version.version()];
      ++count;
      bytes = version.bytes();
    }
  }
  const auto most = std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second.first; });
  if (most == counts.end() && light.target.version().empty()) return;
  light.target.Clear();
  light.sending = {};
  light.stored_at.reset();
  if (most == counts.end()) return;
  light.target.set_version(most->first);
  light.target.set_bytes(most->second.second);
  for (auto& [id, node] : nodes_) {
    if (node.has(scene)) node.scenes.at(scene).has_failed_to_use = false;
  }
}

void SceneLights::spread(const std::string& scene, SceneLightState& light) {
  const std::string& version = light.target.version();
  if (version.empty()) return;
  const TimePoint now = clock_.now();
  for (auto& [id, node] : nodes_) {
    if (!node.has(scene) || node.has_light(scene, version)) continue;
    Node::LoadedScene& lacking = node.scenes.at(scene);
    if (light.stored_at) {
      if (lacking.offered_light == version && now - lacking.light_offered_at < kOfferTimeout) continue;
      lacking.offered_light = version;
      lacking.light_offered_at = now;
      wire::NodeCommand command;
      command.mutable_use_light()->set_scene(scene);
      *command.mutable_use_light()->mutable_light() = light.target;
      delegate_.to_node(id, command);
      continue;
    }
    const auto sending = nodes_.find(light.sending);
    const bool is_sending = sending != nodes_.end() && sending->second.has_light(scene, version);
    if (is_sending && now - light.send_ordered_at < kSendTimeout) return;
    // Prefers another node; if there is none, tries the same node again, which may have failed for a reason that has
    // passed.
    auto holder = std::ranges::find_if(nodes_, [&](const auto& entry) {
      return entry.second.has_light(scene, version) && (!is_sending || entry.first != light.sending);
    });
    if (holder == nodes_.end() && is_sending) holder = sending;
    if (holder == nodes_.end()) return;
    light.sending = holder->first;
    light.send_ordered_at = now;
    delegate_.accept_light(light.target);
    wire::NodeCommand command;
    command.mutable_send_light()->set_scene(scene);
    *command.mutable_send_light()->mutable_light() = light.target;
    delegate_.to_node(holder->first, command);
    return;
  }
}

void SceneLights::switch_to_target(const std::string& scene, SceneLightState& light) {
  if (!light.in_use.empty() && nodes_.count_with_light(scene, light.in_use) == 0) {
    use(scene, light, "");
    if (nodes_.count_with(scene) > 0) {
      delegate_.notice(fmt::format("no node has the computed light of scene '{}': paths are traced", scene), {});
    }
  }
  const std::string& version = light.target.version();
  if (version.empty() || version == light.in_use || nodes_.count_with_light(scene, version) == 0) return;
  const auto is_awaited = [&](const auto& entry) {
    const Node& node = entry.second;
    return node.has(scene) && node.late_for.size() <= 1 && !node.status.draining() && !node.has_light(scene, version) &&
           !node.scenes.at(scene).has_failed_to_use;
  };
  const bool has_waited = light.stored_at && clock_.now() - *light.stored_at >= kSwitchTimeout;
  if (!has_waited && std::ranges::any_of(nodes_, is_awaited)) return;
  use(scene, light, version);
  delegate_.notice(fmt::format("scene '{}' has its light computed: moving pictures use it from now on (version {})",
                               scene, short_version(version)),
                   {});
}

void SceneLights::use(const std::string& scene, SceneLightState& light, const std::string& version) {
  const bool changes_front = light.in_use.empty() != version.empty();
  light.in_use = version;
  if (changes_front) front_changed_(scene);
}

void SceneLights::clear_board(SceneLightState& light) {
  light.computing.clear();
  for (const wire::LightVersion& file : light.board.clear()) delegate_.forget_light(file);
}

void SceneLights::order(const std::string& scene, SceneLightState& light) {
  if (!light.target.version().empty()) return clear_board(light);
  const auto may_compute = [&](const Node& node) {
    if (!node.has(scene) || node.status.draining()) return false;
    const Node::LoadedScene& loaded = node.scenes.at(scene);
    return loaded.can_compute_light && !loaded.has_failed_to_compute;
  };
  for (auto at = light.computing.begin(); at != light.computing.end();) {
    const auto node = nodes_.find(at->first);
    const bool is_left = node != nodes_.end() && may_compute(node->second);
    if (!is_left) light.board.leave(at->first);
    at = is_left ? std::next(at) : light.computing.erase(at);
  }
  std::vector<std::pair<double, NodeId>> others;  // The slowest first.
  for (const auto& [id, node] : nodes_) {
    if (may_compute(node) && !light.computing.contains(id)) others.emplace_back(speeds_.of(node, scene), id);
  }
  if (others.empty() && light.computing.empty()) {
    light.gathering_since = clock_.now();
    return;
  }
  if (clock_.now() - light.gathering_since < gathering_) return;
  std::ranges::sort(others);
  while (!others.empty() && light.computing.size() < LightBoard::kMaxNodes) {
    order_computation(others.back().second, scene, light);
    others.pop_back();
  }
  for (const auto& [id, ordered_at] : light.computing) {
    // A node that was left out reports its stage once more: those that it differed from may be gone.
    if (light.board.nodes() > 0 || clock_.now() - ordered_at < kComputeTimeout) continue;
    order_computation(id, scene, light);
  }
  order_pieces(scene, light);
}

void SceneLights::order_computation(NodeId id, const std::string& scene, SceneLightState& light) {
  light.computing[id] = clock_.now();
  wire::NodeCommand command;
  command.mutable_compute_light()->set_scene(scene);
  delegate_.to_node(id, command);
}

void SceneLights::order_pieces(const std::string& scene, SceneLightState& light) {
  LightBoard::Orders orders = light.board.next(clock_.now(), [&](NodeId id) { return nodes_.at(id).blocks.empty(); });
  for (const wire::LightVersion& file : orders.unneeded) delegate_.forget_light(file);
  for (auto& [id, order] : orders.compute) {
    wire::NodeCommand command;
    order.set_scene(scene);
    *command.mutable_compute_pieces() = std::move(order);
    delegate_.to_node(id, command);
  }
  for (auto& [id, order] : orders.send) {
    delegate_.accept_light(order.piece().file());
    wire::NodeCommand command;
    order.set_scene(scene);
    *command.mutable_send_piece() = std::move(order);
    delegate_.to_node(id, command);
  }
  for (auto& [id, order] : orders.use) {
    wire::NodeCommand command;
    order.set_scene(scene);
    *command.mutable_use_piece() = std::move(order);
    delegate_.to_node(id, command);
  }
}

const std::string& SceneLights::in_use(const std::string& scene) const {
  static const std::string kNone;
  const auto light = lights_.find(scene);
  return light == lights_.end() ? kNone : light->second.in_use;
}

void SceneLights::name(const std::string& scene, wire::View* view) const {
  view->clear_light();
  view->clear_prior_samples();
  view->clear_prior_weight();
  if (!view->stored_light()) return;
  const std::string& version = in_use(scene);
  view->set_stored_light(!version.empty());
  view->set_light(version);
}

std::string SceneLights::summary(const std::string& scene) const {
  const std::string& version = in_use(scene);
  if (!version.empty()) {
    return fmt::format("light {} on {} of {} nodes", short_version(version), nodes_.count_with_light(scene, version),
                       nodes_.count_with(scene));
  }
  const auto light = lights_.find(scene);
  if (light == lights_.end()) return "paths";
  if (!light->second.target.version().empty()) return "paths; light is being given to the nodes";
  const std::map<NodeId, TimePoint>& computing = light->second.computing;
  if (computing.empty()) return "paths";
  const auto node = nodes_.find(computing.begin()->first);
  if (computing.size() > 1 || node == nodes_.end())
    return fmt::format("paths; {} nodes compute light", computing.size());
  return fmt::format("paths; '{}' computes light", printable(node->second.name));
}

}  // namespace cyclorama::coordinator
