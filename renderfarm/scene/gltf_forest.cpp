// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>

#include "renderfarm/scene/gltf_node.h"

namespace cyclorama::scene {
namespace {

using Parents = std::vector<std::optional<std::size_t>>;

Result<Parents> read_children(const GltfArray& nodes, GltfForest* forest) {
  Parents parents(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    TRY_ASSIGN(const GltfObject node, nodes.object(i));
    TRY_ASSIGN(const GltfArray children, node.array("children"));
    for (std::size_t k = 0; k < children.size(); ++k) {
      TRY_ASSIGN(const std::uint64_t child, children.integer(k));
      if (child >= nodes.size()) {
        return gltf_damaged(children.place_of(k), fmt::format("index {} of {} nodes", child, nodes.size()));
      }
      const auto index = static_cast<std::size_t>(child);
      if (parents[index]) {
        return gltf_damaged(children.place_of(k),
                            fmt::format("node {} is already a child of node {}", index, *parents[index]));
      }
      parents[index] = i;
      forest->children[i].push_back(index);
    }
  }
  return parents;
}

/// Checks that the forest has no loops. Every node has at most one parent, so a node that cannot be reached from a root
/// is in a loop or below one.
Status check_no_loops(const GltfForest& forest, const Parents& parents, const GltfArray& nodes) {
  std::vector<bool> reached(parents.size());
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (!parents[i]) waiting.push_back(i);
  }
  while (!waiting.empty()) {
    const std::size_t node = waiting.back();
    waiting.pop_back();
    reached[node] = true;
    waiting.insert(waiting.end(), forest.children[node].begin(), forest.children[node].end());
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) return gltf_damaged(nodes.place_of(i), "the node is part of a loop, or below one");
  }
  return Done{};
}

Result<std::vector<std::size_t>> roots_of_scene(const GltfDocument& document, const Parents& parents, std::size_t index,
                                                GltfNotes* notes) {
  TRY_ASSIGN(const GltfObject scene, document.item("scenes", index));
  TRY_ASSIGN(const GltfArray nodes, scene.array("nodes"));
  std::vector<std::size_t> roots;
  std::vector<bool> named(parents.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    TRY_ASSIGN(const std::uint64_t node, nodes.integer(i));
    if (node >= parents.size()) {
      return gltf_damaged(nodes.place_of(i), fmt::format("index {} of {} nodes", node, parents.size()));
    }
    const auto root = static_cast<std::size_t>(node);
    if (named[root]) notes->add("a scene names a node twice: shown once", nodes.place_of(i));
    if (!named[root]) roots.push_back(root);
    named[root] = true;
  }
  // A node whose ancestor is shown appears below that ancestor, whether the scene lists the node or not. A node without
  // shown ancestors is a root, because the scene lists it.
  std::erase_if(roots, [&](std::size_t root) {
    if (parents[root]) notes->add("a scene names a node that is the child of another: shown once", nodes.place());
    for (std::optional<std::size_t> above = parents[root]; above; above = parents[*above]) {
      if (named[*above]) return true;
    }
    return false;
  });
  return roots;
}

}  // namespace

Result<GltfForest> read_gltf_forest(const GltfDocument& document, GltfNotes* notes) {
  TRY_ASSIGN(const GltfArray nodes, document.root().array("nodes"));
  GltfForest forest;
  forest.children.resize(nodes.size());
  TRY_ASSIGN(const Parents parents, read_children(nodes, &forest));
  TRY(check_no_loops(forest, parents, nodes));
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (!parents[i]) forest.all_roots.push_back(i);
  }
  TRY_ASSIGN(const std::optional<std::size_t> declared, document.index(document.root(), "scene", "scenes"));
  TRY_ASSIGN(const GltfArray scenes, document.root().array("scenes"));
  if (declared || scenes.size() > 0) {
    TRY_ASSIGN(forest.shown_roots, roots_of_scene(document, parents, declared.value_or(0), notes));
    return forest;
  }
  forest.shown_roots = forest.all_roots;
  return forest;
}

}  // namespace cyclorama::scene
