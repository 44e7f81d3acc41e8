// SPDX-License-Identifier: Apache-2.0
/// The stops of a visit: the curator's tour, requests about stops, cuts, and kept pictures while the farm is away.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/guard_band.h"
#include "common/geometry/panorama.h"
#include "common/wire/convert.h"
#include "kiosk/tour/navigation/prediction.h"
#include "kiosk/tour/session/site.h"
#include "kiosk/tour/session/tour.h"

namespace cyclorama::tour {
namespace {

/// A farm that is back within this time is not noticed: the displays hold their picture.
constexpr Duration kAway = std::chrono::seconds(2);
constexpr double kSamePlaceM = 1e-3;
/// Turn to each side that a kept picture allows where it is no panorama, 20 degrees: a perspective's pixels grow fast.
constexpr double kOtherGuardRad = 0.35;

Error no_scene() { return Error(ErrorCode::kUnavailable, "no scene is open yet; wait for the farm"); }

/// Returns the scene's own stops as a tour.
TourPlan plan_of_scene(const Site& site, const std::string& scene) {
  TourPlan plan;
  plan.scene = scene;
  plan.languages = {"en"};
  for (const GuideStop& stop : site.stops)
    plan.stops.push_back({stop, {{"en", printable(stop.title, kMaxTitleBytes)}}, {}, true, {}});
  return plan;
}

/// Adds the levels of a stop to its view; groups that it does not set are as the scene describes them.
void add_lamps(const LampSettings& lamps, const wire::SceneDescription& scene, wire::View* ret_view) {
  if (lamps.empty()) return;
  for (const std::string& group : scene.lamp_groups()) {
    const auto level = lamps.find(group);
    ret_view->add_lamp_levels(level == lamps.end() ? 1.0f : level->second);
  }
}

}  // namespace

void Tour::open(const wire::SceneDescription& scene, TimePoint now) {
  const bool is_other = visit_ && visit_->scene.name() != scene.name();
  Visit visit;
  visit.scene = scene;
  scene_site_ = site_of(scene, &visit.warning);
  if (!visit_ && settings_.resume && settings_.resume->scene == scene.name()) {
    Walker& start = scene_site_.start;
    if (scene_site_.area) start.position_m = scene_site_.area->nearest_allowed(settings_.resume->position_m);
    start.heading_rad = settings_.resume->heading_rad;
  }
  visit_ = std::move(visit);
  if (const auto& names = scene.lamp_groups(); lamps_.groups() != std::vector<std::string>(names.begin(), names.end()))
    lamps_.open({names.begin(), names.end()});
  apply_plan(now);
  visit_->can_walk = can_walk(walk_.site, settings_.navigation.limits);
  if (is_other) begin_cut();
}

Result<TourPlan> Tour::plan_of(const std::string& text, const TourPlan* earlier) const {
  const std::string name = TourFolder(settings_.tour_folder).file().string();
  TRY_ASSIGN(TourPlan plan, parse_tour_plan(text, name, scene_site_.area.get()));
  if (earlier == nullptr) TRY(TourFolder(settings_.tour_folder).read_captions(&plan));
  for (std::size_t i = 0; earlier != nullptr && i < plan.stops.size(); ++i)
    plan.stops[i].captions = earlier->stops[i].captions;
  const auto& groups = visit_->scene.lamp_groups();
  for (const PlannedStop& stop : plan.stops) {
    for (const auto& [group, level] : stop.lamps) {
      if (std::ranges::find(groups, group) != groups.end()) continue;
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{}: stop '{}' sets the lamps '{}', and '{}' has {}; correct 'group'", name,
                               stop.stop.name, printable(group), printable(visit_->scene.name()),
                               groups.empty() ? "none" : printable(fmt::format("{}", fmt::join(groups, ", ")))));
    }
  }
  if (plan.scene.empty() || plan.scene == visit_->scene.name()) return plan;
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("{}: is a tour of '{}', and the visit is to '{}'; correct 'scene', or leave it out", name,
                           printable(plan.scene), printable(visit_->scene.name())));
}

void Tour::apply_plan(TimePoint now) {
  plan_.reset();
  plan_problem_.clear();
  if (!plan_text_) accepted_text_.reset();
  // The tour of before stays as long as the newest file is wrong.
  for (const bool is_earlier : {false, true}) {
    const std::optional<std::string> text = is_earlier ? accepted_text_ : plan_text_;
    if (!text || plan_) continue;
    auto plan = plan_of(*text, is_earlier ? &accepted_ : nullptr);
    if (plan) {
      plan_ = *std::move(plan);
      accepted_text_ = *text;
      accepted_ = *plan_;
    } else if (plan_problem_.empty()) {
      plan_problem_ = plan.error().message();
    }
  }
  Site site = plan_ ? with_plan(scene_site_, *plan_, settings_.navigation.limits) : scene_site_;
  change(SceneOpened{visit_->scene.name(), std::move(site)}, now);
  kept_shown_.reset();
  are_pictures_told_ = false;
  lamps_of_stop_.reset();
  open_captions();
}

void Tour::read_plan() {
  if (settings_.tour_folder.empty()) return;
  auto read = TourFolder(settings_.tour_folder).read();
  const TimePoint now = SteadyClock().now();
  {
    const std::lock_guard lock(mutex_);
    if (!read && read.error().code() != ErrorCode::kNotFound) {
      plan_problem_ = read.error().message();
      return;
    }
    const std::optional<std::string> text = read ? std::optional(*std::move(read)) : std::nullopt;
    auto times = TourFolder(settings_.tour_folder).caption_times(newest_plan_);
    if (text == plan_text_ && times == caption_times_) return;
    if (text != plan_text_) {
      const auto newest = parse_tour_plan(text.value_or(""), "");
      newest_plan_ = newest ? *newest : TourPlan();
      times = TourFolder(settings_.tour_folder).caption_times(newest_plan_);
    }
    plan_text_ = text;
    caption_times_ = std::move(times);
    if (visit_) apply_plan(now);
    pacer_.request_again();
  }
  wake();
}

void Tour::begin_cut() {
  ++cuts_;
  first_after_cut_ = newest_number_ + 1;
  pose_sent_.reset();
  pacer_.request_again();
}

void Tour::go_to(std::size_t stop, TimePoint now) {
  if (walk_.site.is_held) return show_kept(stop, now);
  const WalkEvent event = way_to(walk_, stop);
  change(event, now);
  if (std::holds_alternative<CutToStop>(event)) begin_cut();
}

void Tour::keep_visiting(TimePoint now) {
  if (!visit_) return;
  const bool is_away = farm_away_ && now - farm_lost_at_ >= kAway;
  if (is_away && !kept_shown_) {
    if (const auto stop = nearest_kept()) show_kept(*stop, now);
  }
  if (walk_.navigation.steering_source != SteeringSource::kGuide) return;
  const auto due = guide_cut(walk_.navigation.guide, walk_.navigation.walker, walk_.site, now);
  const auto stop = due ? showable(*due, 1) : std::nullopt;
  if (stop && can_go_to(walk_, *stop)) go_to(*stop, now);
}

std::optional<std::size_t> Tour::nearest_kept() const {
  if (pictures_ == nullptr) return std::nullopt;
  std::optional<std::size_t> nearest;
  const auto distance = [&](std::size_t stop) {
    return (walk_.site.stops[stop].position_m - walk_.navigation.walker.position_m).norm();
  };
  for (std::size_t stop = 0; stop < walk_.site.stops.size(); ++stop) {
    if (!can_go_to(walk_, stop) || !pictures_->is_kept(walk_.site.stops[stop].name)) continue;
    if (!nearest || distance(stop) < distance(*nearest)) nearest = stop;
  }
  return nearest;
}

std::optional<std::size_t> Tour::showable(std::size_t stop, int step) const {
  if (!walk_.site.is_held) return stop;
  const auto count = static_cast<int>(walk_.site.stops.size());
  for (int i = 0; i < count; ++i) {
    const auto candidate = static_cast<std::size_t>(((static_cast<int>(stop) + i * step) % count + count) % count);
    if (pictures_->is_kept(walk_.site.stops[candidate].name)) return candidate;
  }
  return std::nullopt;
}

void Tour::show_kept(std::size_t stop, TimePoint now) {
  auto picture = pictures_->read(walk_.site.stops[stop].name);
  if (!picture) return;  // Another stop's is tried in the next round.
  if (!walk_.site.is_held) change(Held{}, now);
  const GuideStop& place = walk_.site.stops[stop];
  if (kept_shown_ || (place.position_m - walk_.navigation.walker.position_m).norm() > kSamePlaceM)
    change(CutToStop{stop}, now);
  begin_cut();
  const std::uint64_t number = ++newest_number_;
  wire::ShowMessage begin;
  *begin.mutable_begin() = std::move(picture->view);
  begin.mutable_begin()->set_number(number);
  begin.set_cuts(cuts_);
  hub_.send(std::make_shared<const wire::ShowMessage>(std::move(begin)));
  for (wire::Tile& tile : picture->tiles) {
    wire::ShowMessage message;
    *message.mutable_tile() = std::move(tile);
    message.mutable_tile()->set_view_number(number);
    hub_.send(std::make_shared<const wire::ShowMessage>(std::move(message)));
  }
  wire::ShowMessage end;
  *end.mutable_end() = std::move(picture->end);
  end.mutable_end()->set_view_number(number);
  if (const auto show_at = schedule_.frame_at(now)) *end.mutable_show_at() = *show_at;
  hub_.send(std::make_shared<const wire::ShowMessage>(std::move(end)));
  kept_shown_ = stop;
}

wire::View Tour::view_of(const GuideStop& stop, const Projection& wanted) const {
  wire::View view;
  Walker walker;
  walker.position_m = stop.position_m;
  to_wire(eye_of(walker), view.mutable_eye_m());
  view.set_heading_rad(stop.heading_rad);
  const bool is_panorama = std::holds_alternative<Panorama>(wanted.shape);
  to_wire(with_guard_band(wanted, is_panorama ? std::numbers::pi : kOtherGuardRad), view.mutable_panorama());
  view.set_samples(static_cast<std::uint32_t>(settings_.picture.samples));
  view.set_jpeg_quality(static_cast<std::uint32_t>(settings_.picture.jpeg_quality));
  view.set_subsample_chroma(settings_.picture.subsample_chroma);
  return view;
}

void Tour::tend_pictures(TimePoint now) {
  if (pictures_ == nullptr || !visit_) return;
  if (auto wanted = hub_.wanted()) {
    // Displays come one after another, so that what they need together never shrinks; pictures would be fetched anew.
    if (wanted_ && wanted_->viewing == wanted->viewing)
      wanted->shape = covering(wanted_->shape, wanted->shape).value_or(wanted->shape);
    if (wanted != wanted_) are_pictures_told_ = false;
    wanted_ = wanted;
  }
  if (wanted_ && !std::exchange(are_pictures_told_, true)) {
    KeptVisit visit;
    visit.scene = visit_->scene;
    to_wire(*wanted_, &visit.wanted);
    const std::uint64_t scene = checksum_of(visit.scene.SerializeAsString());
    std::vector<StopPictures::Wanted> list;
    for (std::size_t i = 0; i < walk_.site.stops.size(); ++i) {
      const GuideStop& stop = walk_.site.stops[i];
      if (plan_ && !plan_->stops[i].keep) continue;
      wire::View view = view_of(stop, *wanted_);
      if (plan_) add_lamps(plan_->stops[i].lamps, visit_->scene, &view);
      list.push_back({stop.name, std::move(view), scene});
    }
    pictures_->set_wanted(visit, std::move(list));
  }
  const auto steered_at = walk_.navigation.steered_at;
  const bool is_idle = hub_.count() == 0 || (steered_at && now - *steered_at >= settings_.fetch_after);
  pictures_->allow(!farm_away_ && (is_idle || is_fetch_requested_));
}

void Tour::tend_lamps(TimePoint now) {
  const std::optional<std::size_t>& stop = walk_.navigation.stop;
  if (plan_ && stop && stop != lamps_of_stop_) {
    lamps_of_stop_ = stop;
    const Status wanted = lamps_.want(plan_->stops[*stop].lamps);
    CHECK(wanted.has_value());  // plan_of() has checked the names, and the file's reader the levels.
  }
  lamps_.step(now);
}

void Tour::show_tour(TimePoint now) {
  tend_pictures(now);
  show_captions();
  if (!visit_ || walk_.site.stops.empty()) return;
  const auto& stops = walk_.site.stops;
  inspection_.set_gauge("stops", static_cast<double>(stops.size()));
  if (plan_ && !plan_->title.empty())
    inspection_.set_fact("tour", printable(plan_->title.at(plan_->languages.front()), 200));
  if (const auto at = walk_.navigation.stop) inspection_.set_fact("stop", printable(stops[*at].title, 200));
  if (pictures_ == nullptr) return;
  const StopPictures::Progress progress = pictures_->progress();
  if (progress.kept == progress.wanted) is_fetch_requested_ = false;
  inspection_.set_gauge("kept_stops", static_cast<double>(progress.kept));
  inspection_.set_gauge("kept_mib", static_cast<double>(progress.bytes) / (1 << 20));
  inspection_.set_fact("kept_pictures", progress.trouble.empty()
                                            ? fmt::format("{} of {}", progress.kept, progress.wanted)
                                            : fmt::format("{} of {}: {}", progress.kept, progress.wanted,
                                                          printable(progress.trouble, 200)));
}

Result<wire::StopList> Tour::list_stops() {
  const std::lock_guard lock(mutex_);
  if (!visit_) return no_scene();
  wire::StopList list;
  for (std::size_t i = 0; i < walk_.site.stops.size(); ++i) {
    const GuideStop& stop = walk_.site.stops[i];
    wire::StopSummary* const summary = list.add_stops();
    summary->set_name(stop.name);
    summary->set_is_kept(pictures_ != nullptr && pictures_->is_kept(stop.name));
    if (!plan_) {
      (*summary->mutable_titles())[""] = stop.title;
      continue;
    }
    for (const auto& [language, text] : plan_->stops[i].title) (*summary->mutable_titles())[language] = text;
    for (const auto& [language, text] : plan_->stops[i].text) (*summary->mutable_texts())[language] = text;
  }
  if (walk_.navigation.stop) list.set_at(static_cast<std::uint32_t>(*walk_.navigation.stop));
  list.set_is_led(walk_.navigation.guide.is_led);
  list.set_problem(plan_problem_);
  list.set_has_captions(plan_ && plan_->captions);
  for (const std::string& language : caption_languages_) list.add_caption_languages(language);
  if (!plan_) return list;
  if (!plan_->title.empty()) list.set_tour_title(plan_->title.at(plan_->languages.front()));
  for (const std::string& language : plan_->languages) list.add_languages(language);
  return list;
}

Result<wire::GoToStopReply> Tour::go_to_stop(const wire::GoToStopRequest& request) {
  wire::GoToStopReply reply;
  {
    const std::lock_guard lock(mutex_);
    if (!visit_) return no_scene();
    if (!request.has_name() && std::abs(request.step()) != 1)
      return Error(ErrorCode::kInvalidArgument, fmt::format("step is {}; it must be 1 or -1", request.step()));
    const auto& stops = walk_.site.stops;
    std::optional<std::size_t> stop;
    if (request.has_name()) {
      const auto found = std::ranges::find(stops, request.name(), &GuideStop::name);
      if (found != stops.end()) stop = static_cast<std::size_t>(found - stops.begin());
    } else {
      stop = stop_after(walk_, request.step());
    }
    if (!stop)
      return Error(ErrorCode::kNotFound, stops.empty() ? "the tour has no stops" : "no stop has this name; list them");
    if (!can_go_to(walk_, *stop))
      return Error(ErrorCode::kInvalidArgument, "nobody can walk in this scene; correct 'walkable' in its scene.toml");
    const std::optional<std::size_t> shown =
        request.has_name() && walk_.site.is_held && !pictures_->is_kept(stops[*stop].name)
            ? std::nullopt
            : showable(*stop, request.has_name() ? 1 : request.step());
    if (!shown) return Error(ErrorCode::kUnavailable, "the farm is away, and no picture of the stop is kept");
    reply.set_name(stops[*shown].name);
    go_to(*shown, SteadyClock().now());
  }
  wake();
  return reply;
}

Result<wire::AddStopReply> Tour::add_stop(const wire::AddStopRequest& request) {
  if (settings_.tour_folder.empty())
    return Error(ErrorCode::kNotFound, "no tour's folder is set; name one in site.toml, [tour] folder");
  const std::lock_guard one(editing_);
  PlannedStop planned;
  TourPlan otherwise;
  std::shared_ptr<const WalkableArea> area;
  {
    const std::lock_guard lock(mutex_);
    if (!visit_ || walk_.site.area == nullptr) return no_scene();
    constexpr double kTenth = 0.1 * kRadiansPerDegree;
    const Walker& walker = walk_.navigation.walker;
    planned.stop.position_m = walker.position_m;
    planned.stop.heading_rad = kTenth * std::round(wrapped_angle(walker.heading_rad) / kTenth);
    otherwise = plan_of_scene(scene_site_, visit_->scene.name());
    area = walk_.site.area;
  }
  planned.stop.name = request.name();
  if (!request.title().empty()) planned.title = {{"", request.title()}};
  wire::AddStopReply reply;
  TRY_ASSIGN(*reply.mutable_name(), TourFolder(settings_.tour_folder).add(std::move(planned), otherwise, *area));
  read_plan();
  return reply;
}

Result<wire::UndoStopReply> Tour::undo_stop() {
  if (settings_.tour_folder.empty())
    return Error(ErrorCode::kNotFound, "no tour's folder is set; name one in site.toml, [tour] folder");
  const std::lock_guard one(editing_);
  TRY(TourFolder(settings_.tour_folder).undo());
  read_plan();
  return wire::UndoStopReply();
}

Result<wire::SetLampsReply> Tour::set_lamps(const wire::SetLampsRequest& request) {
  wire::SetLampsReply reply;
  {
    const std::lock_guard lock(mutex_);
    if (!visit_) return no_scene();
    TRY(lamps_.want({request.levels().begin(), request.levels().end()}));
    for (const std::string& group : lamps_.groups()) reply.add_groups(group);
  }
  wake();
  return reply;
}

Result<wire::FetchPicturesReply> Tour::fetch_pictures() {
  if (pictures_ == nullptr)
    return Error(ErrorCode::kNotFound, "no pictures are kept; start cyclorama-tour with --pictures FOLDER");
  const std::lock_guard lock(mutex_);
  is_fetch_requested_ = true;
  return wire::FetchPicturesReply();
}

}  // namespace cyclorama::tour
