// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/display_hub.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama {
namespace {
constexpr int kLargestPx = 16384;  // Panorama::validate()'s.
}

Panorama covering(const Panorama& a, const Panorama& b) {
  if (a == b) return a;
  Panorama both;
  both.azimuth_span_rad = std::max(a.azimuth_span_rad, b.azimuth_span_rad);
  both.tan_elevation_top = std::max(a.tan_elevation_top, b.tan_elevation_top);
  both.tan_elevation_bottom = std::min(a.tan_elevation_bottom, b.tan_elevation_bottom);
  const auto rows_per_tan = [](const Panorama& p) {
    return p.height_px / (p.tan_elevation_top - p.tan_elevation_bottom);
  };
  const double width = both.azimuth_span_rad / std::min(a.radians_per_px(), b.radians_per_px());
  const double height =
      (both.tan_elevation_top - both.tan_elevation_bottom) * std::max(rows_per_tan(a), rows_per_tan(b));
  both.width_px = static_cast<int>(std::min(std::ceil(width - 1e-6), double{kLargestPx}));
  both.height_px = static_cast<int>(std::min(std::ceil(height - 1e-6), double{kLargestPx}));
  return both;
}

Status DisplayHub::join(const std::shared_ptr<DisplayLink>& link, std::string name, const Panorama& wanted) {
  const std::lock_guard lock(mutex_);
  if (closed_) return *closed_;
  if (members_.size() >= kMostDisplays)
    return Error(ErrorCode::kBusy, "as many displays as may dial in are here already");
  members_.push_back({link, std::move(name), wanted});
  link->send_heading(heading_rad_, shutter_ns_);
  return Done{};
}

void DisplayHub::leave(const DisplayLink* link) {
  // Destroyed outside the lock: it may be the last reference.
  std::vector<Member> gone;
  const std::lock_guard lock(mutex_);
  const auto first = std::stable_partition(members_.begin(), members_.end(),
                                           [link](const Member& member) { return member.link.get() != link; });
  gone.assign(std::make_move_iterator(first), std::make_move_iterator(members_.end()));
  members_.erase(first, members_.end());
}

void DisplayHub::send_heading(double heading_rad, std::int64_t shutter_ns) {
  const std::lock_guard lock(mutex_);
  heading_rad_ = heading_rad;
  shutter_ns_ = shutter_ns;
  for (const Member& member : members_) member.link->send_heading(heading_rad, shutter_ns);
}

std::size_t DisplayHub::send(const SharedShowMessage& message) {
  const std::lock_guard lock(mutex_);
  std::size_t lost = 0;
  for (const Member& member : members_) {
    if (member.link->send(message)) ++lost;
  }
  return lost;
}

std::optional<Panorama> DisplayHub::wanted() const {
  const std::lock_guard lock(mutex_);
  if (members_.empty()) return std::nullopt;
  Panorama all = members_.front().wanted;
  for (const Member& member : members_) all = covering(all, member.wanted);
  return all;
}

std::size_t DisplayHub::count() const {
  const std::lock_guard lock(mutex_);
  return members_.size();
}

void DisplayHub::close(const Error& reason) {
  const std::lock_guard lock(mutex_);
  closed_ = reason;
  for (const Member& member : members_) member.link->close(reason);
}

}  // namespace cyclorama
