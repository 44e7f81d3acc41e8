// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/frame_assembler.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "appliance/display/tour_clock.h"
#include "common/base/picture_cut.h"
#include "common/base/text.h"
#include "common/geometry/picture_place.h"
#include "common/wire/convert.h"

namespace cyclorama::display {
namespace {
constexpr std::size_t kMaxKnownParts = 8;
}  // namespace

/// Pictures of frames that are no longer shown, reused for later frames, so that memory is not mapped anew for every
/// frame. Thread-safe: the last holder of a picture returns it.
class FrameAssembler::PictureStore : public std::enable_shared_from_this<PictureStore> {
 public:
  /// The pixels are uninitialised.
  std::shared_ptr<PlanarPicture> take(int width, int height, bool has_half_chroma) {
    std::unique_ptr<PlanarPicture> picture;
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(free_, [&](const auto& p) {
        return p->width() != width || p->height() != height || p->has_half_chroma() != has_half_chroma;
      });
      if (!free_.empty()) {
        picture = std::move(free_.back());
        free_.pop_back();
      }
    }
    if (picture == nullptr) picture = std::make_unique<PlanarPicture>(width, height, has_half_chroma);
    return {picture.release(),
            [store = shared_from_this()](PlanarPicture* p) { store->give_back(std::unique_ptr<PlanarPicture>(p)); }};
  }

 private:
  void give_back(std::unique_ptr<PlanarPicture> picture) {
    const std::lock_guard lock(mutex_);
    if (free_.size() < static_cast<std::size_t>(kMaxFramesInFlight)) free_.push_back(std::move(picture));
  }
  std::mutex mutex_;
  std::vector<std::unique_ptr<PlanarPicture>> free_;
};

/// Keeps the newest depth, for frames of the same view that come without depth. Thread-safe.
class FrameAssembler::DepthStore {
 public:
  void put(std::uint64_t view, std::shared_ptr<const InverseDepthImage> depth) {
    const std::lock_guard lock(mutex_);
    if (view < view_) return;  // Decode threads may finish frames in any order.
    view_ = view;
    depth_ = std::move(depth);
  }
  /// Returns null if the newest depth is of another view.
  [[nodiscard]] std::shared_ptr<const InverseDepthImage> of(std::uint64_t view) const {
    const std::lock_guard lock(mutex_);
    return view == view_ ? depth_ : nullptr;
  }
  /// Forgets the depth: another session numbers its views anew.
  void clear() {
    const std::lock_guard lock(mutex_);
    view_ = 0;
    depth_.reset();
  }

 private:
  mutable std::mutex mutex_;
  std::uint64_t view_ = 0;
  std::shared_ptr<const InverseDepthImage> depth_;
};

/// One frame in assembly, shared by the assembler and the decode jobs. The last of its holders to finish delivers or
/// drops it.
class FrameAssembler::Assembly {
 public:
  Assembly(DisplayFrame frame, bool has_depth, const KnownParts& known, std::shared_ptr<PictureStore> pictures,
           std::shared_ptr<DepthStore> depths, FrameSink* sink, const Clock* clock,
           std::shared_ptr<std::atomic<int>> in_flight)
      : frame_(std::move(frame)),
        shown_(known.parts),
        grid_(known.grid),
        pictures_(std::move(pictures)),
        depths_(std::move(depths)),
        sink_(*sink),
        clock_(*clock),
        in_flight_(std::move(in_flight)),
        covered_(width(), height()) {
    frame_.turn_limit_rad = shown_->turn_limit_rad;
    frame_.parts = {shown_, &shown_->parts};
    if (has_depth) {
      const PixelRect cells = depth_cells({0, 0, width(), height()});
      depth_ = std::make_shared<InverseDepthImage>(cells.width, cells.height);
    }
    ++*in_flight_;
  }
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  /// Runs when all holders are done: the assembler after the frame's end, each job after its tile.
  ~Assembly() {
    --*in_flight_;
    // A pool that ends destroys jobs without running them.
    if (failure_.empty() && (!is_complete_ || decoded_ != frame_.decoded)) failure_ = "the display stops";
    if (!failure_.empty()) {
      sink_.frame_dropped(frame_.number, failure_);
      return;
    }
    if (picture_ == nullptr) make_room(true);  // No head shows any of this frame's tiles.
    frame_.picture = std::move(picture_);
    add_mesh();
    frame_.decoded_at = clock_.now();
    sink_.frame_ready(std::move(frame_));
  }

  [[nodiscard]] std::uint64_t number() const { return frame_.number; }
  [[nodiscard]] bool has_failed() const { return has_failed_; }

  /// Keeps the first failure as the reason.
  void fail(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = reason;
    has_failed_ = true;
  }

  /// Records the arrival of a tile. Errors: kBadData if its rectangle does not match the tile grid, or another tile
  /// already covers it.
  Status claim(const wire::Tile& tile) {
    TRY(validate(tile, width(), height()));
    const int x = static_cast<int>(tile.x_px());
    const int y = static_cast<int>(tile.y_px());
    const int right = x + static_cast<int>(tile.width_px());
    const int bottom = y + static_cast<int>(tile.height_px());
    const auto refuse = [&](const char* what) {
      return Error(ErrorCode::kBadData,
                   fmt::format("the tile of {}x{} at ({}, {}) {}", right - x, bottom - y, x, y, what));
    };
    if ((right % kCutPx != 0 && right != width()) || (bottom % kCutPx != 0 && bottom != height())) {
      return refuse("does not end on a cut of 16 pixels");
    }
    frame_.bytes += tile.jpeg().size();
    if (frame_.bytes > kMaxFrameBytes) return refuse("makes the frame larger than 256 MiB");
    if (!covered_.cover(x, y, right - x, bottom - y)) return refuse("covers a place that another tile covers");
    ++frame_.tiles;
    return Done{};
  }

  /// Returns whether a claimed tile must be decoded. The first such tile determines the frame's chroma sampling.
  /// Errors: kBadData if its header is not that of a JPEG of YCbCr with half or full chroma.
  Result<bool> prepare(const wire::Tile& tile, JpegDecoder* decoder) {
    if (!shown_->meets(place_of(tile))) return false;
    ++frame_.decoded;
    if (picture_ != nullptr) return true;
    TRY_ASSIGN(const JpegHeader header, decoder->header_of(std::as_bytes(std::span(tile.jpeg()))));
    if (!header.has_half_chroma) {
      return Error(ErrorCode::kBadData, "the JPEG's colours are kept neither as 4:2:0 nor as 4:4:4");
    }
    make_room(*header.has_half_chroma);
    return true;
  }

  /// Runs on a decode thread; tiles never overlap, so jobs write to different pixels.
  void decode(const wire::Tile& tile, JpegDecoder* decoder) {
    if (has_failed_) return;
    const auto jpeg = std::as_bytes(std::span(tile.jpeg()));
    const Status decoded = decoder->decode_into(jpeg, picture_.get(), place_of(tile));
    if (decoded && depth_ != nullptr) decode_depth(tile);
    ++decoded_;
    if (!decoded) fail(tile, decoded.error());
  }
  void fail(const wire::Tile& tile, const Error& error) {
    fail(fmt::format("the tile at ({}, {}): {}", tile.x_px(), tile.y_px(), error.message()));
  }

  /// Records the end of the frame.
  void close(const wire::FrameEnd& end, const ShowAt& show_at) {
    is_complete_ = true;
    frame_.show_at = show_at;
    const std::size_t empty = covered_.count() - covered_.covered();
    if (!end.complete()) {
      fail(end.reason().empty() ? "the farm gave the frame up"
                                : "the farm gave the frame up: " + printable(end.reason(), 200));
    } else if (end.tiles() != frame_.tiles || empty > 0) {
      fail(fmt::format("{} of {} tiles came", frame_.tiles, end.tiles()) +
           (empty > 0 ? fmt::format(", and {} of {} cells of the picture are empty", empty, covered_.count()) : ""));
    }
  }

 private:
  static PixelRect place_of(const wire::Tile& tile) {
    return {static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()), static_cast<int>(tile.width_px()),
            static_cast<int>(tile.height_px())};
  }
  void decode_depth(const wire::Tile& tile) {
    const auto bytes = std::as_bytes(std::span(tile.depth()));
    const Status decoded = bytes.empty() ? Status(Error(ErrorCode::kBadData, "the depth is missing"))
                                         : decode_inverse_depth(bytes, depth_cells(place_of(tile)), depth_.get());
    if (decoded) return;
    const std::lock_guard lock(mutex_);
    if (!frame_.depth_trouble.empty()) return;
    frame_.depth_trouble = fmt::format("the tile at ({}, {}): {}", tile.x_px(), tile.y_px(), decoded.error().message());
  }
  void add_mesh() {
    if (!frame_.depth_trouble.empty()) return;
    if (depth_ != nullptr) depths_->put(frame_.number, depth_);
    if (const auto depth = depths_->of(frame_.number)) {
      frame_.mesh = std::make_shared<const ReprojectionMesh>(grid_, *depth);
    }
  }
  [[nodiscard]] int width() const { return width_px(frame_.shape); }
  [[nodiscard]] int height() const { return frame_.stacked * height_px(frame_.shape); }
  void make_room(bool has_half_chroma) { picture_ = pictures_->take(width(), height(), has_half_chroma); }

  DisplayFrame frame_;
  std::shared_ptr<const ShownParts> shown_;
  std::shared_ptr<const ReprojectionGrid> grid_;
  std::shared_ptr<PictureStore> pictures_;
  std::shared_ptr<DepthStore> depths_;
  std::shared_ptr<InverseDepthImage> depth_;  // Null if the frame comes without depth.
  std::shared_ptr<PlanarPicture> picture_;    // Created before the first job that decodes into it is submitted.
  FrameSink& sink_;
  const Clock& clock_;
  std::shared_ptr<std::atomic<int>> in_flight_;
  CoveredCells covered_;
  std::atomic<std::uint32_t> decoded_{0};
  bool is_complete_ = false;
  std::atomic<bool> has_failed_{false};
  std::mutex mutex_;
  std::string failure_;  // Guarded by mutex_, except in the destructor, which runs without other holders.
};

FrameAssembler::FrameAssembler(DecodePool* pool, FrameSink* sink, const Clock* clock, ShownByHeads shown)
    : pool_(*pool),
      sink_(*sink),
      clock_(*clock),
      shown_(std::move(shown)),
      pictures_(std::make_shared<PictureStore>()),
      depths_(std::make_shared<DepthStore>()),
      in_flight_(std::make_shared<std::atomic<int>>(0)) {}

FrameAssembler::~FrameAssembler() { stream_lost(); }

void FrameAssembler::take(wire::ShowMessage message) {
  switch (message.message_case()) {
    case wire::ShowMessage::kBegin:
      return begin(message.begin(), message.cuts());
    case wire::ShowMessage::kTile:
      return tile(std::move(*message.mutable_tile()));
    case wire::ShowMessage::kEnd:
      return end(message.end(), show_at_of(message));
    case wire::ShowMessage::kHeading:
    case wire::ShowMessage::kClock:
    case wire::ShowMessage::kCaption:
    case wire::ShowMessage::MESSAGE_NOT_SET:
      CHECK(false);
  }
}

void FrameAssembler::stream_lost() {
  if (current_ != nullptr) current_->fail("the connection to the tour was lost");
  current_.reset();
  refused_number_ = 0;
  depths_->clear();
}

std::uint64_t FrameAssembler::set_heads(std::vector<HeadFootprint> heads) {
  shown_.heads = std::move(heads);
  known_parts_.clear();
  return order_;
}

void FrameAssembler::begin(const wire::View& view, std::uint64_t cuts) {
  if (current_ != nullptr) current_->fail("another frame began before its end");
  current_.reset();
  refused_number_ = view.number();
  const auto drop = [&](const std::string& reason) { sink_.frame_dropped(view.number(), reason); };
  if (const Status valid = validate(view); !valid) return drop(valid.error().message());
  const Projection picture = *from_wire(view.panorama());
  if (!has_same_places(picture.shape, shown_.wall)) return drop("a picture of another kind than this wall's");
  if (picture.stacked() == 2 && !shown_.stereo) return drop("a picture for two eyes; this display shows one");
  const int width = picture.width_px();
  const int height = picture.height_px();
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kMaxFramePx) {
    return drop(fmt::format("a picture of {}x{} pixels; at most {} pixels are shown", width, height, kMaxFramePx));
  }
  if (*in_flight_ >= kMaxFramesInFlight) return drop("frames come faster than this display decodes them");
  refused_number_ = 0;
  DisplayFrame frame;
  frame.order = ++order_;
  frame.number = view.number();
  frame.cuts = cuts;
  frame.heading_rad = view.heading_rad();
  frame.eye_m = from_wire(view.eye_m());
  frame.shutter_ns = view.shutter_ns();
  frame.shape = picture.shape;
  frame.stacked = picture.stacked();
  frame.begun_at = clock_.now();
  current_ = std::make_shared<Assembly>(std::move(frame), view.depth(), parts_of(picture, view.depth()), pictures_,
                                        depths_, &sink_, &clock_, in_flight_);
}

const FrameAssembler::KnownParts& FrameAssembler::parts_of(const Projection& picture, bool has_depth) {
  for (const KnownParts& known : known_parts_) {
    if (known.picture == picture && known.has_depth == has_depth && known.mesh_cells == mesh_cells_) return known;
  }
  if (known_parts_.size() >= kMaxKnownParts) known_parts_.erase(known_parts_.begin());
  // A picture without depth may be a kept one, which has to serve for a whole visit.
  ShownParts parts = shown_parts(shown_.heads, picture.shape, shown_.wall, !has_depth);
  if (picture.stacked() == 2) parts = shown_by_both_eyes(parts, height_px(picture.shape));
  known_parts_.push_back({picture, has_depth, mesh_cells_, std::make_shared<const ShownParts>(std::move(parts)),
                          std::make_shared<const ReprojectionGrid>(picture, mesh_cells_ * kDepthCellPx)});
  return known_parts_.back();
}

void FrameAssembler::tile(wire::Tile tile) {
  if (current_ == nullptr) {
    // A refused begin was already reported; any other frame without a begin is reported once.
    if (tile.view_number() != refused_number_)
      sink_.frame_dropped(tile.view_number(), "a tile came without its frame's begin");
    refused_number_ = tile.view_number();
    return;
  }
  if (current_->has_failed()) return;
  if (tile.view_number() != current_->number()) {
    return current_->fail(fmt::format("a tile of frame {} came between its own", tile.view_number()));
  }
  if (const Status claimed = current_->claim(tile); !claimed) return current_->fail(claimed.error().message());
  const auto wanted = current_->prepare(tile, &headers_);
  if (!wanted) return current_->fail(tile, wanted.error());
  if (!*wanted) return;
  pool_.submit(
      [assembly = current_, moved = std::move(tile)](JpegDecoder& decoder) { assembly->decode(moved, &decoder); });
}

void FrameAssembler::end(const wire::FrameEnd& end, const ShowAt& show_at) {
  if (current_ == nullptr) {
    if (end.view_number() != refused_number_) sink_.frame_dropped(end.view_number(), "its end came without its begin");
    refused_number_ = 0;
    return;
  }
  if (end.view_number() != current_->number()) {
    current_->fail(fmt::format("the end of frame {} came before its own", end.view_number()));
  }
  current_->close(end, show_at);
  current_.reset();
}

}  // namespace cyclorama::display
