// SPDX-License-Identifier: Apache-2.0
/// The sentences and gauges in which Tour reports its state.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "common/base/text.h"
#include "common/geometry/panorama.h"
#include "common/language/marked_texts.h"
#include "kiosk/tour/session/tour.h"

namespace cyclorama::tour {
namespace {
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr Duration kFarmSilent = std::chrono::seconds(10);
}  // namespace

std::string Tour::state_sentence(TimePoint now, bool* ret_healthy) {
  *ret_healthy = false;
  if (farm_away_ && kept_shown_) {
    return fmt::format(
        "The farm is away ({}). The visit goes on at the stops whose pictures are kept, and the tour keeps trying {}; "
        "see that cyclorama-farm and its nodes run there.",
        printable(*farm_away_, 200), settings_.coordinators.front());
  }
  if (farm_away_) {
    return fmt::format(
        "The farm is away ({}). The wall holds its last picture, and the tour keeps trying {}; see that "
        "cyclorama-farm and its nodes run there.",
        printable(*farm_away_, 200), settings_.coordinators.front());
  }
  if (!view_refused_.empty()) return fmt::format("No picture can be requested: {}.", view_refused_);
  const std::size_t displays = hub_.count();
  if (displays == 0)
    return "No display is connected. Start cyclorama-display, and see that its --tour is this address.";
  const auto completed_at = log_.frame_completed_at();
  const auto asked_at = pacer_.asked_at();
  if (pacer_.in_flight() > 0 && asked_at && now - *asked_at > kFarmSilent &&
      (!completed_at || now - *completed_at > kFarmSilent)) {
    return fmt::format("The farm has not answered a view for {:.0f} s. See the state of the coordinator and its nodes.",
                       to_seconds(now - *asked_at));
  }
  const std::string no_captions = captions_.trouble();
  *ret_healthy = visit_->warning.empty() && plan_problem_.empty() && no_captions.empty();
  if (!visit_->warning.empty()) return visit_->warning;
  if (!plan_problem_.empty()) return "The tour of before stays: " + plan_problem_;
  if (!no_captions.empty()) return fmt::format(translatable("Nothing can be written on the wall: {}."), no_captions);
  const std::string picture =
      log_.refinement().value_or(fmt::format(translatable("{:.1f} frames a second"), log_.frames_per_second(now)));
  const auto synchronised_share = displays > 1 ? roster_.synchronised_share() : std::nullopt;
  std::string sentence = fmt::format(
      fmt::runtime(plural("Visiting '{}', {}, {} display, steered by {}.",
                          "Visiting '{}', {}, {} displays, steered by {}.", static_cast<long long>(displays))),
      printable(visit_->scene.title()), picture, displays, to_text(walk_.navigation.steering_source));
  if (synchronised_share)
    sentence += fmt::format(" The displays are synchronised ({:.2f} %).", 100.0 * *synchronised_share);
  if (trackers_.empty()) sentence += " No tracker is connected, so only keys steer.";
  return sentence;
}

void Tour::show_state(TimePoint now) {
  shown_at_ = now;
  show_tour(now);
  bool healthy = false;
  std::string sentence = state_sentence(now, &healthy);
  inspection_.set_state(std::move(sentence), healthy);
  log_.refresh(now);
  inspection_.set_gauge("displays", static_cast<double>(hub_.count()));
  inspection_.set_gauge("frame_lead_ms", to_milliseconds(schedule_.frame_lead(now)));
  inspection_.set_gauge("heading_lead_ms", to_milliseconds(schedule_.heading_lead(now)));
  if (const auto synchronised_share = roster_.synchronised_share())
    inspection_.set_gauge("synchronised_percent", 100.0 * *synchronised_share);
  inspection_.set_table(roster_.table());
  inspection_.set_gauge("trackers", static_cast<double>(trackers_.size()));
  inspection_.set_gauge("latency_ms", to_milliseconds(meter_.latency().value_or(Duration::zero())));
  inspection_.set_gauge("interval_ms", to_milliseconds(meter_.interval().value_or(Duration::zero())));
  inspection_.set_gauge("predicted_m", predicted_m_);
  inspection_.set_gauge("frames_in_flight", static_cast<double>(pacer_.in_flight()));
  if (!visit_) return;
  const Walker& walker = walk_.navigation.walker;
  inspection_.set_gauge("heading_deg", kDegreesPerRadian * wrapped_angle(walker.heading_rad));
  inspection_.set_gauge("eye_x_m", walker.position_m.x());
  inspection_.set_gauge("eye_z_m", walker.position_m.y());
  inspection_.set_gauge("forward_m_per_s", walker.velocity_m_per_s.y());
  inspection_.set_gauge("sideways_m_per_s", walker.velocity_m_per_s.x());
  inspection_.set_gauge("turn_deg_per_s", kDegreesPerRadian * walker.turn_rate_rad_per_s);
  if (const auto left = turn_left(walk_.navigation, settings_.navigation, now))
    inspection_.set_gauge("turn_left_s", std::max(0.0, to_seconds(*left)));
  inspection_.set_fact("steered_by", to_text(walk_.navigation.steering_source));
}

}  // namespace cyclorama::tour
