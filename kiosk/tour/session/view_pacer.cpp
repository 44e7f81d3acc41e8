// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/view_pacer.h"

#include <google/protobuf/util/message_differencer.h>

#include <iterator>

namespace cyclorama {

bool ViewPacer::wants(const wire::View& view, TimePoint now) const {
  if (in_flight_.size() >= kFramesInFlight) return false;
  if (!newest_ || (!farm_refines_ && now - *asked_at_ >= kAtRest)) return true;
  wire::View same = *newest_;
  same.set_number(view.number());
  same.set_shutter_ns(view.shutter_ns());  // A newer camera picture of a still tag shows nothing new.
  return !google::protobuf::util::MessageDifferencer::Equals(same, view);
}

void ViewPacer::asked(const wire::View& view, TimePoint now) {
  in_flight_.insert(view.number());
  newest_ = view;
  asked_at_ = now;
}

std::size_t ViewPacer::began(std::uint64_t number) {
  const auto first_kept = in_flight_.lower_bound(number);
  const auto passed_over = static_cast<std::size_t>(std::distance(in_flight_.begin(), first_kept));
  in_flight_.erase(in_flight_.begin(), first_kept);
  return passed_over;
}

void ViewPacer::ended(std::uint64_t number) { in_flight_.erase(number); }

void ViewPacer::lost() {
  if (in_flight_.size() > 1) in_flight_.erase(in_flight_.begin(), std::prev(in_flight_.end()));
}

}  // namespace cyclorama
