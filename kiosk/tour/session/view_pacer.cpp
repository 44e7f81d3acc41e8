// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/view_pacer.h"

#include <google/protobuf/util/message_differencer.h>

namespace cyclorama::tour {

bool ViewPacer::wants(const wire::View& view, TimePoint now) const {
  if (!frames_.has_room()) return false;
  if (!newest_ || (!farm_refines_ && now - *asked_at_ >= kAtRest)) return true;
  wire::View same = *newest_;
  same.set_number(view.number());
  same.set_shutter_ns(view.shutter_ns());  // A newer camera picture of a still tag shows nothing new.
  return !google::protobuf::util::MessageDifferencer::Equals(same, view);
}

void ViewPacer::asked(const wire::View& view, TimePoint now) {
  frames_.add(view.number(), {});
  newest_ = view;
  asked_at_ = now;
}

std::size_t ViewPacer::began(std::uint64_t number) { return frames_.skip_before(number); }

void ViewPacer::ended(std::uint64_t number) { frames_.finish(number); }

void ViewPacer::lost() {
  frames_.lose();
  frames_.send();
}

}  // namespace cyclorama::tour
