// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/view_window.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/wire/convert.h"

namespace cyclorama {
namespace {

Error broken(const std::string& what) { return Error(ErrorCode::kBadData, "the farm " + what); }

bool same_panorama(const wire::View& a, const wire::View& b) {
  const auto ours = from_wire(a.panorama());
  const auto theirs = from_wire(b.panorama());
  return ours && theirs && *ours == *theirs;
}

}  // namespace

bool ViewWindow::put(wire::View view) {
  CHECK(view.number() > newest_);
  newest_ = view.number();
  const bool dropped = waiting_.has_value();
  waiting_ = std::move(view);
  return dropped;
}

std::optional<wire::View> ViewWindow::take_sendable() {
  if (!is_sendable()) return std::nullopt;
  in_flight_.push_back(*std::exchange(waiting_, std::nullopt));
  return in_flight_.back();
}

Status ViewWindow::begin(const wire::View& view) {
  if (open_) return broken(fmt::format("began frame {} before it ended another", view.number()));
  const auto asked =
      std::ranges::find_if(in_flight_, [&](const wire::View& sent) { return sent.number() == view.number(); });
  if (asked == in_flight_.end()) return broken(fmt::format("sent frame {}, which nobody asked for", view.number()));
  if (!same_panorama(*asked, view)) return broken(fmt::format("sent frame {} in another shape", view.number()));
  in_flight_.erase(in_flight_.begin(), asked);  // Older numbers were skipped.
  open_ = true;
  corners_.clear();
  covered_px_ = 0;
  return Done{};
}

Status ViewWindow::accept(const wire::Tile& tile) {
  if (!open_ || tile.view_number() != in_flight_.front().number()) {
    return broken(fmt::format("sent a tile of frame {}, which is not open", tile.view_number()));
  }
  TRY_ASSIGN(const Panorama picture, from_wire(in_flight_.front().panorama()));
  if (const Status fits = validate(tile, picture); !fits) return broken("sent a " + fits.error().message());
  if (!corners_.emplace(tile.x_px(), tile.y_px()).second) {
    return broken(fmt::format("sent the tile at ({}, {}) twice", tile.x_px(), tile.y_px()));
  }
  covered_px_ += std::uint64_t{tile.width_px()} * tile.height_px();
  return Done{};
}

Status ViewWindow::end(const wire::FrameEnd& end) {
  if (!open_ || end.view_number() != in_flight_.front().number()) {
    return broken(fmt::format("ended frame {}, which is not open", end.view_number()));
  }
  const wire::Panorama& picture = in_flight_.front().panorama();
  const std::uint64_t whole_px = std::uint64_t{picture.width_px()} * picture.height_px();
  if (end.complete() && (covered_px_ != whole_px || end.tiles() != corners_.size())) {
    return broken(
        fmt::format("called frame {} complete with {} of {} pixels", end.view_number(), covered_px_, whole_px));
  }
  in_flight_.pop_front();
  open_ = false;
  return Done{};
}

std::optional<std::uint64_t> ViewWindow::lose() {
  std::optional<std::uint64_t> open_number;
  if (open_) open_number = in_flight_.front().number();
  if (!waiting_ && !in_flight_.empty()) waiting_ = std::move(in_flight_.back());
  in_flight_.clear();
  open_ = false;
  return open_number;
}

}  // namespace cyclorama
