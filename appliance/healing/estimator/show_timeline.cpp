// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/show_timeline.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::healing {
namespace {

constexpr double kStill_px = 0.1;  // In the plane's pixels; patches are not located more precisely.
constexpr std::ptrdiff_t kCompared = 8;

/// Returns the approximate distance by which the content moved. A shift causes a difference of slope times distance, so
/// the distance follows from the sums over the picture.
double shift_px(const LightPlane& a, const LightPlane& b) {
  if (a.light.empty() || a.width() != b.width() || a.height() != b.height()) return 0.0;
  double differences = 0.0;
  double slopes = 0.0;
  for (int y = 0; y + 1 < a.height(); y += 2) {
    const float* p = a.light.at(0, y);
    const float* q = b.light.at(0, y);
    for (int x = 0; x + 1 < a.width(); x += 2) {
      differences += static_cast<double>(std::abs(p[x] - q[x]));
      slopes += static_cast<double>(std::hypot(p[x + 1] - p[x], p[x + a.width()] - p[x]));
    }
  }
  return slopes > 1e-9 ? differences / slopes : 0.0;
}

}  // namespace

void ShowTimeline::add(const ShownPicture& shown) {
  const auto at = std::ranges::lower_bound(entries_, shown.lit_at, {}, &Entry::lit_at);
  if (at != entries_.end() && at->lit_at == shown.lit_at) {
    if (at->picture != shown.picture) *at = Entry{shown.lit_at, shown.picture, shown.number, {}};
  } else {
    entries_.insert(at, Entry{shown.lit_at, shown.picture, shown.number, {}});
  }
  while (entries_.size() > 1 && entries_[1].lit_at + kKept < entries_.back().lit_at) entries_.pop_front();
}

const LightPlane& ShowTimeline::light_of(Entry* entry) {
  if (entry->light.light.empty() && entry->picture) entry->light = shone_light(*entry->picture, projector_, factor_);
  return entry->light;
}

std::pair<ShowTimeline::Entries::iterator, ShowTimeline::Entries::iterator> ShowTimeline::shown(TimePoint from,
                                                                                                TimePoint until) {
  const std::pair nothing(entries_.end(), entries_.end());
  if (!(until > from) || entries_.empty() || entries_.front().lit_at > from || until > until_.at) return nothing;
  // The pictures that came after `from`, and the one before them.
  const auto first = std::ranges::upper_bound(entries_, from, {}, &Entry::lit_at) - 1;
  const auto end = std::ranges::lower_bound(entries_, until, {}, &Entry::lit_at);
  // The next entry must have the next number, else another picture may have come before `until`.
  for (auto one = first; one != end; ++one) {
    const std::uint64_t next = one + 1 != entries_.end() ? (one + 1)->number : until_.number + 1;
    if (next != one->number + 1) return nothing;
  }
  return {first, end};
}

bool ShowTimeline::is_still(TimePoint from, TimePoint until) {
  const auto [first, end] = shown(from, std::max(until, until_.at));
  if (first == end) return false;
  // Compares only a subset of many pictures, so that few are computed for this alone.
  const std::ptrdiff_t stride = std::max<std::ptrdiff_t>(1, (end - first) / kCompared);
  double moved_px = 0.0;
  for (auto one = first; end - one > 1;) {
    const auto next = one + std::min(stride, end - one - 1);
    const LightPlane& light = light_of(&*one);
    const LightPlane& other = light_of(&*next);
    if (light.light.empty() != other.light.empty()) return false;
    moved_px += shift_px(light, other);
    if (!(moved_px < kStill_px)) return false;
    one = next;
  }
  return true;
}

std::optional<ShowTimeline::Exposed> ShowTimeline::between(TimePoint opened, TimePoint closed) {
  auto [from, end] = shown(opened, closed);
  if (from == end) return std::nullopt;
  Exposed exposed;
  if (end - from == 1) {
    exposed.light = light_of(&*from);
    return exposed;
  }
  const double whole = std::chrono::duration<double>(closed - opened).count();
  const auto first = from;
  for (; from != end; ++from) {
    const TimePoint begun = std::max(from->lit_at, opened);
    const TimePoint over = from + 1 != end ? std::min((from + 1)->lit_at, closed) : closed;
    const auto share = static_cast<float>(std::chrono::duration<double>(over - begun).count() / whole);
    const LightPlane& light = light_of(&*from);
    if (light.light.empty()) continue;
    if (exposed.light.light.empty()) exposed.light = {factor_, Image<float, 1>(light.width(), light.height())};
    for (std::size_t i = 0; i < light.light.data().size(); ++i)
      exposed.light.light.data()[i] += share * light.light.data()[i];
  }
  exposed.motion_px = shift_px(light_of(&*first), light_of(&*(end - 1)));
  return exposed;
}

}  // namespace cyclorama::healing
