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

/// What the balance thought of a block.
struct BlockForecast {
  double seconds = 0.0;    ///< Of one thread of speed 1; 0: not known.
  double speed = 1.0;      ///< Of one of its node's threads.
  bool stealable = false;  ///< May be moved while nobody has begun it.
};

/// One picture in the making: which tiles are still missing, and who was told to make them. Pure; thread-bound.
///
/// Invariants: 1. the tiles of the first blocks tile the picture (tiles_of); 2. no pixel is delivered twice, whoever
/// makes it; 3. a block given again is one tile of an earlier one, or, after cut(), a part of it: then whoever is
/// first, the maker of the tile or of one of its parts, makes the other's pixels unwanted.
class FrameAssembly {
 public:
  struct Block {
    NodeId node{};
    PixelRect rect;
    BlockForecast forecast{};
    std::vector<PixelRect> tiles{};
    std::size_t delivered = 0;  ///< Of the tiles, by this block.
    bool moved = false;         ///< To another node, before it was begun.
    bool wanted = true;         ///< False once others were told to make the rest of it.
    bool ended = false;
    wire::BlockEnd end{};
  };
  enum class Verdict {
    kNew,
    kDuplicate,  ///< Somebody else was quicker.
    kForeign,    ///< No tile of that block: its node is broken.
  };

  /// A block of the first plan. Numbers never come again.
  void plan(std::uint64_t block, NodeId node, const PixelRect& rect, const BlockForecast& forecast = {});
  /// A missing tile that nobody is to make, given to another node.
  void replan(std::uint64_t block, NodeId node, const PixelRect& tile);
  /// Cuts a missing tile that nobody is to make into at most `parts` of kMinPartPx or more. Returns them.
  std::vector<PixelRect> cut(const PixelRect& tile, std::size_t parts);
  /// The block goes to another node, under another number. Precondition: it is wanted, and no tile of it came.
  void move(std::uint64_t from, std::uint64_t block, NodeId node, double speed);

  [[nodiscard]] Verdict accept(std::uint64_t block, const PixelRect& tile);
  void end(std::uint64_t block, const wire::BlockEnd& end);
  /// The block's node is gone or too slow: returns the tiles that nobody else was told to make, and wants it no more.
  std::vector<PixelRect> give_up(std::uint64_t block);

  /// The block's node is only slow: what it has not delivered counts no attempt.
  void forgive_attempt(std::uint64_t block);

  [[nodiscard]] bool has(std::uint64_t block) const { return blocks_.contains(block); }
  [[nodiscard]] const std::map<std::uint64_t, Block>& blocks() const { return blocks_; }
  /// How often a tile was given out, to nodes that are at work on it or failed.
  [[nodiscard]] int attempts(const PixelRect& tile) const;
  /// All tiles came, and, unless blocks were given again, so did the end of each wanted block.
  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] bool is_missing_tiles() const { return !missing_.empty(); }
  [[nodiscard]] std::uint32_t delivered() const { return delivered_; }
  [[nodiscard]] bool was_reassigned() const { return reassigned_; }

  struct Summary {
    double render_seconds = 0.0;  ///< Wall time of the rays, of the node that took longest.
    double away_seconds = 0.0;    ///< Wall time of a block and of other rays that it waited for, of the longest.
    double encode_seconds = 0.0;  ///< Thread time, of the block with the most.
    double cpu_seconds = 0.0;
    std::uint64_t rays = 0;
    std::vector<balance::MeasuredBlock> costs{};  ///< Of the blocks that their node finished.
    std::map<NodeId, double> loads{};             ///< Thread time of the rays, by node.
  };
  /// Of the blocks that have ended.
  [[nodiscard]] Summary summary() const;

 private:
  /// False when somebody has delivered it, or a part of it.
  bool take(const PixelRect& tile);
  [[nodiscard]] bool is_untouched(const PixelRect& tile) const;

  std::map<std::uint64_t, Block> blocks_;
  std::map<PixelRect, int> attempts_;
  std::map<PixelRect, int> missing_;                   ///< And how many wanted blocks will bring it.
  std::map<PixelRect, std::vector<PixelRect>> parts_;  ///< Of tiles that were cut; the parts are missing_ or delivered.
  std::uint32_t delivered_ = 0;
  bool reassigned_ = false;
};

}  // namespace cyclorama::coordinator
