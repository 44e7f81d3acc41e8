// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Returns the error of a node that violates the protocol: kInvalidArgument.
[[nodiscard]] inline Error broken(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

/// The nodes that are connected, and which of them can do what. Pure; thread-bound.
class NodeTable {
 public:
  using Map = std::map<NodeId, Node>;

  [[nodiscard]] Map::iterator begin() { return nodes_.begin(); }
  [[nodiscard]] Map::iterator end() { return nodes_.end(); }
  [[nodiscard]] Map::const_iterator begin() const { return nodes_.begin(); }
  [[nodiscard]] Map::const_iterator end() const { return nodes_.end(); }
  [[nodiscard]] Map::iterator find(NodeId id) { return nodes_.find(id); }
  [[nodiscard]] Map::const_iterator find(NodeId id) const { return nodes_.find(id); }
  /// Precondition: contains(id).
  [[nodiscard]] Node& at(NodeId id) { return nodes_.at(id); }
  [[nodiscard]] const Node& at(NodeId id) const { return nodes_.at(id); }
  [[nodiscard]] bool contains(NodeId id) const { return nodes_.contains(id); }
  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }

  void add(NodeId id, TimePoint now);
  /// Returns what was known of the node; null if it is not there.
  std::optional<Node> remove(NodeId id);

  [[nodiscard]] std::size_t count_with(const std::string& scene) const;
  [[nodiscard]] std::size_t count_with_light(const std::string& scene, const std::string& version) const;
  /// Returns the largest memory that the scene takes at a node that has it; 0 if none has.
  [[nodiscard]] std::uint64_t memory_of(const std::string& scene) const;
  /// Returns the nodes that have the scene, and this version of its light unless it is empty, and are neither late for
  /// the account nor draining; if there are none, the late and draining ones, too. `not_to` is left out.
  [[nodiscard]] std::vector<NodeId> able(const std::string& scene, AccountId account, const std::string& light,
                                         NodeId not_to = {}) const;
  /// Returns the one with the fewest blocks for its threads. Precondition: there is one, and all are connected.
  [[nodiscard]] NodeId least_loaded(const std::vector<NodeId>& nodes) const;
  /// Returns the threads of these nodes together.
  [[nodiscard]] double threads_of(const std::set<NodeId>& nodes) const;
  /// Returns the cpu-seconds that all nodes give per second.
  [[nodiscard]] double capacity() const;

 private:
  Map nodes_;
};

}  // namespace cyclorama::coordinator
