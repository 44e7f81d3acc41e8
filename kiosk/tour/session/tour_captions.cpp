// SPDX-License-Identifier: Apache-2.0
/// What the visit writes on the wall: the text of the stop where the visitor stands, in the chosen languages.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/picture_place.h"
#include "kiosk/tour/session/tour.h"

namespace cyclorama::tour {
namespace {

/// Distance at which a visitor has left a stop, in the visitor's metres; its text is read from its surroundings.
constexpr double kLeaveM = 1.5;

const std::string* text_in(const Texts& texts, const std::string& language) {
  const auto text = texts.find(language);
  return text == texts.end() ? nullptr : &text->second;
}

}  // namespace

void Tour::open_captions() {
  captions_of_stop_.reset();
  are_captions_told_ = false;
  const std::vector<std::string> before = std::exchange(caption_languages_, {});
  if (!plan_ || !plan_->captions) return;
  const auto has = [this](const std::string& tag) { return std::ranges::count(plan_->languages, tag) > 0; };
  // A curator who types a text sees it in the language that was chosen.
  const bool is_kept = !before.empty() && std::ranges::all_of(before, has);
  caption_languages_ = is_kept ? before : plan_->captions->shown;
}

std::optional<CaptionScript> Tour::caption_script() const {
  if (!plan_ || !plan_->captions || !captions_of_stop_ || caption_languages_.empty() || !caption_wall_)
    return std::nullopt;
  const PlannedStop& stop = plan_->stops[captions_of_stop_->first];
  CaptionScript script;
  script.since = captions_of_stop_->second;
  script.style = *plan_->captions;
  script.wall = *caption_wall_;
  for (const std::string& language : caption_languages_) {
    CaptionScript::Part part;
    part.language = language;
    if (const std::string* const title = text_in(stop.title, language)) part.title = *title;
    if (const std::string* const text = text_in(stop.text, language)) part.text = *text;
    if (const auto cues = stop.captions.find(language); cues != stop.captions.end()) part.cues = cues->second;
    script.parts.push_back(std::move(part));
  }
  return script;
}

void Tour::tend_captions(TimePoint now) {
  if (!plan_ || !plan_->captions) {
    if (!std::exchange(are_captions_told_, true)) captions_.write(std::nullopt);
    return;
  }
  const Walker& walker = walk_.navigation.walker;
  if (captions_of_stop_) {
    const auto away = (walk_.site.stops[captions_of_stop_->first].position_m - walker.position_m).norm();
    if (away > kLeaveM * walk_.site.walking_scale) {
      captions_of_stop_.reset();
      are_captions_told_ = false;
    }
  }
  const auto arrived = stop_at(walk_.site, walker);
  if (arrived && (!captions_of_stop_ || captions_of_stop_->first != *arrived)) {
    captions_of_stop_ = {*arrived, now};
    are_captions_told_ = false;
  }
  // The next visitor reads what the curator has chosen.
  const bool is_unattended =
      walk_.navigation.steering_source == SteeringSource::kGuide && !walk_.navigation.guide.is_led;
  if (is_unattended && caption_languages_ != plan_->captions->shown) {
    caption_languages_ = plan_->captions->shown;
    are_captions_told_ = false;
  }
  if (std::exchange(are_captions_told_, true)) return;
  captions_.write(caption_script());
}

void Tour::show_captions() {
  if (!plan_ || !plan_->captions) return;
  std::optional<CaptionWall> wall = caption_wall_;
  if (const auto wanted = hub_.wanted()) {
    // The picture that a display requests is about as fine as its projectors.
    const PixelDensity density = hub_.density();
    const double otherwise = std::max(1.0, pixel_scale(wanted->shape).u_per_across);
    const bool is_known = density.min_px_per_rad > 0.0;
    wall = CaptionWall{wanted->shape, is_known ? density.min_px_per_rad : otherwise,
                       is_known ? density.max_px_per_rad : otherwise};
  }
  if (wall != caption_wall_) are_captions_told_ = false;
  caption_wall_ = wall;
  inspection_.set_fact("captions", fmt::format("{}", fmt::join(caption_languages_, ", ")));
}

void Tour::choose_next_language() {
  if (!plan_ || !plan_->captions) return;
  const std::vector<std::string>& all = plan_->languages;
  const auto now = caption_languages_.empty() ? all.end() : std::ranges::find(all, caption_languages_.front());
  const auto next = now == all.end() ? all.begin() : now + 1;
  caption_languages_.clear();
  if (next != all.end()) caption_languages_.push_back(*next);
  are_captions_told_ = false;
}

Result<wire::SetCaptionsReply> Tour::set_captions(const wire::SetCaptionsRequest& request) {
  wire::SetCaptionsReply reply;
  {
    const std::lock_guard lock(mutex_);
    if (!visit_) return Error(ErrorCode::kUnavailable, "no scene is open yet; wait for the farm");
    if (!plan_ || !plan_->captions)
      return Error(ErrorCode::kNotFound, "the tour writes nothing on the wall; give its tour.toml a table [captions]");
    const std::vector<std::string> languages(request.languages().begin(), request.languages().end());
    for (const std::string& tag : languages) {
      if (std::ranges::count(plan_->languages, tag) > 0) continue;
      return Error(ErrorCode::kNotFound, fmt::format("the tour has no language '{}', but {}", printable(tag),
                                                     fmt::join(plan_->languages, ", ")));
    }
    if (languages.size() > kMaxShownLanguages)
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{} languages; at most {} are written at once", languages.size(), kMaxShownLanguages));
    if (request.next()) {
      choose_next_language();
    } else {
      caption_languages_ = languages;
      are_captions_told_ = false;
    }
    for (const std::string& language : caption_languages_) reply.add_languages(language);
  }
  wake();
  return reply;
}

}  // namespace cyclorama::tour
