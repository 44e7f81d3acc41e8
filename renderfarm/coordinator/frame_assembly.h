// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/balance/work_grid.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// The balancer's forecast of a block.
struct BlockForecast {
  double seconds = 0.0;    ///< Time on one thread of speed 1; 0: unknown.
  double speed = 1.0;      ///< Speed of one thread of the node.
  bool stealable = false;  ///< True if the block may be moved until a node begins it.
};

/// Returns a time that a node reported, clamped to a plausible range, because plans and accounts use it.
[[nodiscard]] double measured_seconds(double seconds);

/// One picture being assembled: the tiles that are still missing, and the nodes that render them. Pure; thread-bound.
///
/// Invariants: 1. the tiles of the first blocks cover the picture exactly once (tiles_of); 2. no pixel is delivered
/// twice, whichever node renders it; 3. a reassigned block is one tile of an earlier block, or, after cut(), a part of
/// such a tile: once the tile is delivered, its parts are unwanted, and once any part is delivered, the whole tile is
/// unwanted.
class FrameAssembly {
 public:
  struct Block {
    NodeId node{};
    PixelRect rect;
    BlockForecast forecast{};
    std::vector<PixelRect> tiles{};
    std::size_t delivered = 0;  ///< Number of tiles that this block delivered.
    bool moved = false;         ///< True if it was moved to another node before it was begun.
    bool wanted = true;         ///< False once its remaining tiles were assigned to others.
    bool ended = false;
    wire::BlockEnd end{};
    /// Returns true while its node owes the rest of it.
    [[nodiscard]] bool is_outstanding() const { return !ended && wanted; }
  };
  enum class Verdict {
    kNew,
    kDuplicate,  ///< The tile was delivered earlier by another node.
    kForeign,    ///< The block has no such tile; its node violates the protocol.
  };

  /// Adds a block of the first plan. Numbers are never reused.
  void plan(std::uint64_t block, NodeId node, const PixelRect& rect, const BlockForecast& forecast = {});
  /// Assigns a missing tile that no node is rendering to another node.
  void replan(std::uint64_t block, NodeId node, const PixelRect& tile);
  /// Cuts a missing tile that no node is rendering into at most `parts` pieces of at least kMinPartPx; returns the
  /// pieces.
  std::vector<PixelRect> cut(const PixelRect& tile, std::size_t parts);
  /// Moves the block to another node, under another number. Precondition: it is wanted and has delivered no tile.
  void move(std::uint64_t from, std::uint64_t block, NodeId node, double speed);

  [[nodiscard]] Verdict accept(std::uint64_t block, const PixelRect& tile);
  void end(std::uint64_t block, const wire::BlockEnd& end);
  /// Marks a block as unwanted, because its node is gone or too slow. Returns the missing tiles that no other node
  /// renders.
  std::vector<PixelRect> give_up(std::uint64_t block);

  /// Subtracts the attempts at a block's missing tiles, because its node is merely slow.
  void forgive_attempt(std::uint64_t block);

  [[nodiscard]] bool has(std::uint64_t block) const { return blocks_.contains(block); }
  [[nodiscard]] const std::map<std::uint64_t, Block>& blocks() const { return blocks_; }
  /// Returns the numbers of the outstanding blocks of each node that owes any, in ascending order.
  [[nodiscard]] const std::map<NodeId, std::vector<std::uint64_t>>& outstanding() const { return outstanding_; }
  /// Returns true while the node owes a block.
  [[nodiscard]] bool waits_for(NodeId node) const { return outstanding_.contains(node); }
  /// Returns how often a tile was assigned to nodes that are rendering it or have failed.
  [[nodiscard]] int attempts(const PixelRect& tile) const;
  /// Returns true once all tiles have arrived and, unless blocks were reassigned, all wanted blocks have ended.
  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] bool is_missing_tiles() const { return !missing_.empty(); }
  [[nodiscard]] std::uint32_t delivered() const { return delivered_; }
  [[nodiscard]] bool was_reassigned() const { return reassigned_; }

  struct Summary {
    double render_seconds = 0.0;  ///< Wall time of tracing, maximum over the nodes.
    double away_seconds = 0.0;    ///< Wall time of a block and its wait for other blocks, maximum over the blocks.
    double encode_seconds = 0.0;  ///< Thread time of encoding, maximum over the blocks.
    double cpu_seconds = 0.0;
    std::uint64_t rays = 0;
    std::vector<balance::MeasuredBlock> costs{};  ///< Costs of the blocks that their nodes finished.
    std::map<NodeId, double> loads{};             ///< Thread time of tracing, by node.
  };
  /// Summarizes the blocks that have ended.
  [[nodiscard]] Summary summary() const;

 private:
  /// Returns false if the tile or a part of it has been delivered.
  bool take(const PixelRect& tile);
  [[nodiscard]] bool is_untouched(const PixelRect& tile) const;

  /// To be called before the block ends or is no longer wanted.
  void settle(std::uint64_t number, const Block& block);

  std::map<std::uint64_t, Block> blocks_;
  std::map<NodeId, std::vector<std::uint64_t>> outstanding_;
  std::map<PixelRect, int> attempts_;
  std::map<PixelRect, int> missing_;                   ///< Number of wanted blocks that contain each missing tile.
  std::map<PixelRect, std::vector<PixelRect>> parts_;  ///< Parts of cut tiles. Each part is in `missing_` or delivered.
  std::uint32_t delivered_ = 0;
  bool reassigned_ = false;
};

}  // namespace cyclorama::coordinator
