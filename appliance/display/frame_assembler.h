// SPDX-License-Identifier: Apache-2.0
/// Assembles whole frames from the messages of the Show stream. A frame is shown whole or not at all.
///
///   begin ──► tiles ──► end(complete) ──► tiles that a head shows are decoded ──► frame_ready
///     any missing, duplicate, foreign, misplaced or damaged tile, an end that is not complete, a begin or a lost
///     stream before the end  ──────────────────────────► frame_dropped, once, with the first reason
///
/// A frame whose depth is missing or damaged is shown without a mesh. A frame without depth that has the same view as
/// the newest frame with depth (the farm refines a picture at rest) is seen from the same eye and shares that depth.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "appliance/display/decode_pool.h"
#include "appliance/display/frame.h"
#include "appliance/display/shown_parts.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::display {

/// Receives finished frames. Called on the assembler's thread or on decode threads; calls may overlap, so
/// implementations must be thread-safe.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void frame_ready(DisplayFrame frame) = 0;
  virtual void frame_dropped(std::uint64_t number, const std::string& reason) = 0;

 protected:
  FrameSink() = default;
  FrameSink(const FrameSink&) = default;
  FrameSink& operator=(const FrameSink&) = default;
};

/// Limits of a frame's size and of the number of frames in assembly; they bound the memory, whatever the input.
inline constexpr std::size_t kMaxFramePx = std::size_t{64} << 20;
inline constexpr std::size_t kMaxFrameBytes = std::size_t{256} << 20;
inline constexpr int kMaxFramesInFlight = 3;

/// The heads' view of any picture; parts that no head shows are not decoded.
struct ShownByHeads {
  std::vector<HeadFootprint> heads;
  PictureShape wall;    ///< Shape of the whole wall's picture; a picture of another kind or tilt is refused.
  bool stereo = false;  ///< False: the heads cannot show two eyes' pictures; such frames are refused.
};

/// Assembles frames from messages, which come from one thread at a time. Borrows the pool, the sink and the clock; they
/// must outlive the assembler and its frames.
class FrameAssembler {
 public:
  FrameAssembler(DecodePool* pool, FrameSink* sink, const Clock* clock, ShownByHeads shown);
  ~FrameAssembler();
  FrameAssembler(const FrameAssembler&) = delete;
  FrameAssembler& operator=(const FrameAssembler&) = delete;

  /// Takes the next message. Precondition: it is a begin, a tile or an end.
  void take(wire::ShowMessage message);
  /// Drops the unfinished frame, since the stream has ended.
  void stream_lost();
  /// Sets what the heads show from the next frame on. Returns the newest DisplayFrame::order so far: frames with a
  /// greater order are assembled for these heads.
  std::uint64_t set_heads(std::vector<HeadFootprint> heads);
  /// Sets the number of cells of depth (kDepthCellPx) between two vertices of a mesh, from the next frame on.
  /// Precondition: at least 1.
  void set_mesh_cells(int cells) { mesh_cells_ = cells; }

 private:
  class Assembly;
  class PictureStore;
  class DepthStore;
  /// Data that all frames of the same size share.
  struct KnownParts {
    Projection picture;
    bool has_depth = false;
    int mesh_cells = 1;
    std::shared_ptr<const ShownParts> parts;
    std::shared_ptr<const ReprojectionGrid> grid;
  };

  void begin(const wire::View& view, std::uint64_t cuts);
  void tile(wire::Tile tile);
  void end(const wire::FrameEnd& end, const ShowAt& show_at);
  const KnownParts& parts_of(const Projection& picture, bool has_depth);

  DecodePool& pool_;
  FrameSink& sink_;
  const Clock& clock_;
  ShownByHeads shown_;
  // Parts of the few shapes that were used last: a farm that adapts to its frame budget alternates between a few sizes.
  std::vector<KnownParts> known_parts_;
  JpegDecoder headers_;
  std::shared_ptr<PictureStore> pictures_;
  std::shared_ptr<DepthStore> depths_;
  int mesh_cells_ = 1;
  std::shared_ptr<std::atomic<int>> in_flight_;
  std::shared_ptr<Assembly> current_;  // The frame between begin and end; null if there is none or it was refused.
  std::uint64_t refused_number_ = 0;   // Number of the frame whose remaining messages are ignored.
  std::uint64_t order_ = 0;
};

}  // namespace cyclorama::display
