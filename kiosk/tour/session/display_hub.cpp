// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/display_hub.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/geometry/guard_band.h"

namespace cyclorama::tour {
Status DisplayHub::join(const std::shared_ptr<DisplayLink>& link, std::string name, const Projection& wanted,
                        const PixelDensity& density) {
  const std::lock_guard lock(mutex_);
  if (closed_) return *closed_;
  if (members_.size() >= kMaxDisplays)
    return Error(ErrorCode::kBusy, "the maximum number of displays is connected already");
  for (const Member& member : members_) {
    if (member.wanted.viewing != wanted.viewing) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("display '{}' is here for other eyes, and one picture cannot serve both; give all displays "
                      "of a room the same [stereo], [visitor] and [wall]",
                      member.name));
    }
    if (covering(member.wanted.shape, wanted.shape)) continue;
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("display '{}' is here for a wall of another kind, and one picture cannot serve both; give "
                             "all displays of a room the same [wall]",
                             member.name));
  }
  members_.push_back({link, std::move(name), wanted, density});
  // The other displays show this heading already, or will within a few refreshes.
  link->send_heading(heading_, nullptr);
  if (caption_ != nullptr) link->send_caption(caption_);
  return Done{};
}

void DisplayHub::leave(const DisplayLink* link) {
  // Destroys the links outside the lock: one may be the last reference.
  std::vector<Member> gone;
  const std::lock_guard lock(mutex_);
  const auto first = std::stable_partition(members_.begin(), members_.end(),
                                           [link](const Member& member) { return member.link.get() != link; });
  gone.assign(std::make_move_iterator(first), std::make_move_iterator(members_.end()));
  members_.erase(first, members_.end());
}

void DisplayHub::send_heading(const wire::Heading& heading, const wire::ShowAt* show_at) {
  const std::lock_guard lock(mutex_);
  heading_ = heading;
  for (const Member& member : members_) member.link->send_heading(heading, show_at);
}

void DisplayHub::send_caption(const SharedShowMessage& caption) {
  const std::lock_guard lock(mutex_);
  caption_ = caption;
  for (const Member& member : members_) member.link->send_caption(caption);
}

std::size_t DisplayHub::send(const SharedShowMessage& message) {
  const std::lock_guard lock(mutex_);
  std::size_t lost = 0;
  for (const Member& member : members_) {
    if (member.link->send(message)) ++lost;
  }
  return lost;
}

std::optional<Projection> DisplayHub::wanted() const {
  const std::lock_guard lock(mutex_);
  if (members_.empty()) return std::nullopt;
  Projection all = members_.front().wanted;
  // join() guarantees that the shapes have a common cover.
  for (const Member& member : members_) all.shape = *covering(all.shape, member.wanted.shape);
  return all;
}

PixelDensity DisplayHub::density() const {
  const std::lock_guard lock(mutex_);
  PixelDensity all;
  for (const Member& member : members_) {
    const PixelDensity& one = member.density;
    if (one.min_px_per_rad <= 0.0) continue;
    all.min_px_per_rad =
        all.min_px_per_rad <= 0.0 ? one.min_px_per_rad : std::min(all.min_px_per_rad, one.min_px_per_rad);
    all.max_px_per_rad = std::max(all.max_px_per_rad, one.max_px_per_rad);
  }
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

}  // namespace cyclorama::tour
