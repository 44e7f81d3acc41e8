// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/view_window.h"

#include <fmt/format.h>

#include "common/geometry/picture_place.h"
#include "common/wire/convert.h"

namespace cyclorama::client {
namespace {

Error broken(const std::string& what) { return Error(ErrorCode::kBadData, "the farm " + what); }

bool is_same_place(const wire::View& a, const wire::View& b) {
  return from_wire(a.eye_m()) == from_wire(b.eye_m()) && a.heading_rad() == b.heading_rad();
}

/// Checks that the farm's picture has the requested shape for the same eyes. It may have fewer pixels.
Status check_shape(const Projection& asked, const Projection& begun) {
  const bool fits = begun.width_px() <= asked.width_px() && begun.height_px() <= asked.height_px() &&
                    begun.viewing == asked.viewing &&
                    with_pixels(begun.shape, width_px(asked.shape), height_px(asked.shape)) == asked.shape;
  return fits ? Status(Done{}) : broken("sent a frame of another shape");
}

}  // namespace

Status ViewWindow::take(const wire::SessionReply& reply) {
  if (reply.has_opened() == opened_) return broken("must describe the scene first, and once");
  switch (reply.message_case()) {
    case wire::SessionReply::kOpened:
      TRY(validate(reply.opened()));
      opened_ = true;
      return Done{};
    case wire::SessionReply::kBegin:
      return begin(reply.begin());
    case wire::SessionReply::kTile:
      return accept(reply.tile());
    case wire::SessionReply::kEnd:
      return end(reply.end());
    case wire::SessionReply::MESSAGE_NOT_SET:
      break;
  }
  return broken("sent an unknown message");
}

bool ViewWindow::put(wire::View view) {
  CHECK(view.number() > newest_);
  newest_ = view.number();
  return views_.put(newest_, std::move(view));
}

std::optional<wire::View> ViewWindow::take_sendable() {
  if (!is_sendable()) return std::nullopt;
  return *views_.send();
}

Status ViewWindow::begin(const wire::View& view) {
  if (open_) return broken(fmt::format("began frame {} before it ended another", view.number()));
  const bool is_refined = answered_ && answered_->number() == view.number();
  const wire::View* const asked = is_refined ? &*answered_ : views_.find(view.number());
  if (!asked) {
    return broken(fmt::format("sent frame {}, which was not requested", view.number()));
  }
  if (!is_same_place(view, *asked)) return broken("sent a frame from another position");
  TRY_ASSIGN(const Projection field, from_wire(asked->panorama()));
  const auto begun = from_wire(view.panorama());
  if (!begun) return broken("sent a frame whose " + begun.error().message());
  TRY(check_shape(field, *begun));
  if (!is_refined) views_.skip_before(view.number());
  open_ = *begun;
  open_number_ = view.number();
  covered_ = CoveredCells(begun->width_px(), begun->height_px());
  covered_px_ = 0;
  tiles_ = 0;
  return Done{};
}

Status ViewWindow::accept(const wire::Tile& tile) {
  if (!open_ || tile.view_number() != open_number_) {
    return broken(fmt::format("sent a tile of frame {}, which is not open", tile.view_number()));
  }
  if (const Status fits = validate(tile, open_->width_px(), open_->height_px()); !fits)
    return broken("sent a " + fits.error().message());
  const auto px = [](std::uint32_t value) { return static_cast<int>(value); };  // The values are inside the picture.
  if (!covered_.cover(px(tile.x_px()), px(tile.y_px()), px(tile.width_px()), px(tile.height_px()))) {
    return broken(fmt::format("sent a tile at ({}, {}) over another", tile.x_px(), tile.y_px()));
  }
  ++tiles_;
  covered_px_ += std::uint64_t{tile.width_px()} * tile.height_px();
  return Done{};
}

Status ViewWindow::end(const wire::FrameEnd& end) {
  if (!open_ || end.view_number() != open_number_) {
    return broken(fmt::format("ended frame {}, which is not open", end.view_number()));
  }
  const std::uint64_t whole_px =
      static_cast<std::uint64_t>(open_->width_px()) * static_cast<std::uint64_t>(open_->height_px());
  if (end.complete() && (covered_px_ != whole_px || end.tiles() != tiles_)) {
    return broken(
        fmt::format("called frame {} complete with {} of {} pixels", end.view_number(), covered_px_, whole_px));
  }
  if (auto answered = views_.finish(open_number_)) answered_ = std::move(answered);
  open_.reset();
  return Done{};
}

std::optional<std::uint64_t> ViewWindow::lose() {
  std::optional<std::uint64_t> open_number;
  if (open_) open_number = open_number_;
  views_.lose();
  answered_.reset();
  open_.reset();
  opened_ = false;
  return open_number;
}

}  // namespace cyclorama::client
