// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// Divides the computation of one scene's light among nodes: which node computes, has or lacks which piece.
///
///   nobody has it ──► ordered from an idle node ──► a node has it ──► on its way here ──► here ──► given to those that
///        ▲                        │ silent, gone             │ gone                                lack it
///        └────────────────────────┴──────────────────────────┘
///
/// Nodes may be at different stages; each gets what its own stage needs. Files stay here only until the nodes at their
/// stage have them; a node that comes later gets them from a node again. Pure; thread-bound.
class LightBoard {
 public:
  /// A node that has not delivered a piece by then may be busy: an idle one computes it, too.
  static constexpr Duration kPieceTimeout = std::chrono::seconds(20);
  /// An order to send or fetch a file is repeated after this time.
  static constexpr Duration kTransferTimeout = std::chrono::seconds(30);
  /// Pieces that a node has to compute at a time.
  static constexpr std::size_t kOrdered = 8;
  /// Files that are here or on their way at a time.
  static constexpr std::size_t kMaxFiles = 64;
  /// Nodes that take part; more would wait for each other most of the time.
  static constexpr std::size_t kMaxNodes = 32;

  struct Orders {
    std::map<NodeId, wire::ComputePieces> compute{};
    std::vector<std::pair<NodeId, wire::LightPieceOrder>> send{};  ///< The file is to be accepted.
    std::vector<std::pair<NodeId, wire::LightPieceOrder>> use{};
    std::vector<wire::LightVersion> unneeded{};  ///< Files that no node needs any more.
  };

  /// Returns false if the node's results differ from those of the nodes before it, as on another kind of processor. It
  /// then takes no part. Errors: kInvalidArgument if the report is broken.
  Result<bool> report(NodeId node, const wire::LightPieces& report);
  void leave(NodeId node);
  /// The file with this SHA-256 has come.
  void stored(const std::string& sha256);
  /// Returns what is due. Only nodes for which `is_idle` returns true get pieces to compute.
  Orders next(TimePoint now, const std::function<bool(NodeId)>& is_idle);
  /// Forgets everything. Returns the files that the coordinator holds or has ordered from nodes.
  std::vector<wire::LightVersion> clear();
  [[nodiscard]] bool has(NodeId node) const { return at_.contains(node); }
  [[nodiscard]] std::size_t nodes() const { return at_.size(); }

 private:
  struct Transfer {
    NodeId node{};
    TimePoint ordered_at{};
  };
  struct Piece {
    wire::LightVersion file{};          ///< Known once a node has it.
    std::set<NodeId> holders{};         ///< Nodes that have its results.
    std::set<NodeId> silent{};          ///< Holders that did not send the file when ordered to.
    std::optional<Transfer> working{};  ///< The node that computes it.
    std::optional<Transfer> sending{};
    bool is_here = false;
    std::map<NodeId, TimePoint> given{};  ///< Nodes that got the order to fetch it, and when.
  };
  struct Stage {
    wire::LightStage stage{};
    std::vector<Piece> pieces{};
  };

  void give_out(Stage& stage, NodeId node, TimePoint now, Orders* orders);
  void order_pieces(TimePoint now, const std::function<bool(NodeId)>& is_idle, Orders* orders);
  void drop_unneeded();
  /// Forgets this stage and the later ones: they belong to another computation than the current one.
  void erase_from(std::uint32_t number);
  void forget_file(Piece* piece);
  /// Returns a node that can send the file; nothing if there is none.
  [[nodiscard]] static std::optional<NodeId> sender_of(const Piece& piece);
  /// Returns true if the node can get the results only by computing them.
  [[nodiscard]] static bool must_compute(const Piece& piece, NodeId node);

  std::map<std::uint32_t, Stage> stages_;     ///< The stages by number.
  std::map<NodeId, std::uint32_t> at_;        ///< The stage of each node that takes part.
  std::size_t files_ = 0;                     ///< Pieces that are here or on their way.
  std::vector<wire::LightVersion> unneeded_;  ///< Files for the next Orders::unneeded.
};

}  // namespace cyclorama::coordinator
