// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/display.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "appliance/display/attract_picture.h"
#include "appliance/display/calibrated_heads.h"
#include "common/base/text.h"
#include "common/opening/wall_clock.h"
#include "common/wire/convert.h"

namespace cyclorama::display {
namespace {

constexpr auto kReconnectAfter = std::chrono::milliseconds(250);
constexpr auto kForAFrame = std::chrono::seconds(2);  // Timeout for a frame from the tour after a new calibration.
constexpr std::size_t kMaxDropsWaiting = 256;
// Cells of depth, of 4 pixels each, between two vertices of a mesh; the time of a software renderer is proportional to
// the number of vertices.
constexpr int kMeshCells = 1;
constexpr int kSoftwareMeshCells = 2;
constexpr char kPassedOver[] = "a newer frame was ready before it could be shown";

std::vector<HeadFootprint> footprints(const std::vector<HeadPlan>& heads) {
  std::vector<HeadFootprint> all;
  for (const HeadPlan& head : heads) all.emplace_back(head.warp, head.mask);
  return all;
}

std::vector<std::string> names_of(const std::vector<InstalledProjector>& projectors) {
  std::vector<std::string> names;
  for (const InstalledProjector& projector : projectors) names.push_back(projector.name);
  return names;
}

std::vector<output::HeadMode> modes_of(const std::vector<InstalledProjector>& projectors) {
  std::vector<output::HeadMode> modes;
  for (const InstalledProjector& projector : projectors)
    modes.push_back({projector.name, projector.lens.width_px, projector.lens.height_px});
  return modes;
}

/// Returns the picture of `frame`. Areas that no head shows are black, since nothing was decoded there.
RgbImage decoded_parts(const DisplayFrame& frame, JpegDecoder* decoder) {
  RgbImage all = decoder->to_rgb(*frame.picture);
  if (frame.parts == nullptr) return all;
  RgbImage shown(all.width(), all.height());
  for (const PixelRect& part : *frame.parts) {
    for (int y = part.y; y < part.y + part.height; ++y) {
      std::copy_n(all.at(part.x, y), 3 * part.width, shown.at(part.x, y));
    }
  }
  return shown;
}

}  // namespace

Result<std::unique_ptr<Display>> Display::start(DisplayOptions options, const Clock& clock) {
  std::unique_ptr<Display> display(new Display(std::move(options), clock));
  TRY(display->prepare());
  return display;
}

Display::Display(DisplayOptions options, const Clock& clock)
    : options_(std::move(options)),
      clock_(clock),
      reporter_(&inspection_, names_of(options_.installation.projectors)),
      mailbox_(options_.installation.projectors.size()),
      patterns_(modes_of(options_.installation.projectors), &mailbox_.patterns, options_.patterns_idle),
      tour_clock_(options_.system_clock),
      hours_(options_.hours, options_.hours_override) {
  if (!options_.reach.empty()) {
    reach_.emplace(options_.reach, options_.help_pressed, modes_of(options_.installation.projectors));
  }
}

Display::~Display() { patterns_.stop(); }

Status Display::prepare() {
  wanted_ = options_.installation.projection(options_.width_px, options_.height_px);
  TRY(wanted_.validate());
  TRY_ASSIGN(std::vector<HeadPlan> heads, first_heads());
  TRY_ASSIGN(channel_, make_channel(options_.tour));
  describe(heads);
  footprints_ = footprints(heads);
  const PixelDensity density = pixel_density(heads);
  ShownByHeads shown{footprints_, wanted_.shape, wanted_.stacked() == 2};

  keep_hours();
  PresentPlan plan;
  plan.open_output = [this] {
    OutputChoice choice = options_.output;
    choice.is_awake = &is_awake_;
    return make_output(choice, options_.installation, options_.refresh_hz, clock_);
  };
  plan.may_change = watch_ != nullptr;
  plan.attract = attract_frame(wanted_.shape);
  if (!options_.attract_picture.empty()) {
    TRY_ASSIGN(plan.attract, attract_frame(wanted_.shape, options_.attract_picture));
  }
  history_ = std::make_unique<ShownHistory>(plan.attract, std::make_shared<const std::vector<HeadPlan>>(heads));
  showing_ = std::make_unique<ShownService>(names_of(options_.installation.projectors), history_.get(), &clock_);
  TRY_ASSIGN(server_, WireServer::start(options_.listen, {&inspection_, &patterns_, showing_.get()}));
  plan.heads = std::move(heads);
  plan.times = options_.attract_times;
  TRY_ASSIGN(present_, PresentThread::start(std::move(plan), &mailbox_, &clock_, options_.on_start_step));
  pool_ = std::make_unique<DecodePool>(options_.decode_threads);
  assembler_ = std::make_unique<FrameAssembler>(pool_.get(), static_cast<FrameSink*>(this), &clock_, std::move(shown));
  note_output();
  hello_.set_name(options_.installation.name);
  hello_.set_heads(static_cast<std::uint32_t>(options_.installation.projectors.size()));
  hello_.set_refresh_hz(options_.refresh_hz);
  hello_.set_min_px_per_rad(density.min);
  hello_.set_max_px_per_rad(density.max);
  to_wire(wanted_, hello_.mutable_wanted());
  if (watch_ != nullptr) watch_->run();
  return Done{};
}

/// Returns the calibrated heads, else the planned ones: a missing or broken calibration must not keep the wall dark.
Result<std::vector<HeadPlan>> Display::first_heads() {
  TRY_ASSIGN(std::vector<HeadPlan> planned, planned_heads(options_.installation, wanted_.shape));
  if (options_.calibration.empty()) return planned;
  watch_ = std::make_unique<CalibrationWatch>(options_.calibration, options_.installation, wanted_.shape, planned);
  auto calibrated = watch_->read();
  if (!calibrated) {
    refuse_calibration(calibrated.error());
    return planned;
  }
  describe_calibration(calibrated->date, calibrated->lacking, calibrated->corrected);
  return std::move(calibrated->heads);
}

void Display::describe_calibration(const std::string& date, const std::vector<std::string>& lacking,
                                   const std::vector<std::string>& corrected) {
  misfit_.reset();
  std::string text = date;
  for (const std::string& name : lacking) text += fmt::format("; '{}' as installed: it was not seen", printable(name));
  for (const std::string& name : corrected) text += fmt::format("; '{}' from where it stands now", printable(name));
  inspection_.set_fact("calibration", std::move(text));
  inspection_.set_fact("calibration_refused", "");
}

void Display::refuse_calibration(const Error& why) {
  const bool is_none = why.code() == ErrorCode::kNotFound;
  if (!is_none) misfit_ = why;
  inspection_.set_fact("calibration_refused", is_none ? "there is none yet" : printable(why.message(), 400));
}

/// Passes a new calibration to the presenter. The heads use it once a frame is decoded for them; reconnecting makes the
/// tour send one.
void Display::keep_calibration() {
  if (watch_ == nullptr) return;
  if (mailbox_.plans.replaced.take() != nullptr) history_->heads_changed();
  const std::unique_ptr<CalibrationUpdate> news = watch_->take();
  if (news == nullptr) return;
  if (news->trouble) return refuse_calibration(*news->trouble);
  describe_calibration(news->date, news->lacking, news->corrected);
  describe(*news->set->plans);
  const bool is_decoded = is_decoded_for(news->footprints);
  if (!is_decoded) {
    hang_up();
    connect_at_ = clock_.now();
  }
  std::vector<HeadFootprint> both = std::exchange(footprints_, news->footprints);
  both.insert(both.end(), footprints_.begin(), footprints_.end());
  news->set->needs_frames_after = assembler_->set_heads(std::move(both));
  news->set->latest_at = clock_.now() + (is_decoded ? Duration::zero() : kForAFrame);
  const HeadPlans plans = news->set->plans;
  history_->heads_wanted(plans, mailbox_.plans.wanted.put(std::move(news->set)) != nullptr);
  inspection_.count("calibrations_taken");
}

/// True if the present picture contains everything that the heads will show: a correction moves them by less than the
/// margin that is decoded around them.
bool Display::is_decoded_for(const std::vector<HeadFootprint>& heads) const {
  const ShownParts now = shown_parts(footprints_, wanted_.shape, wanted_.shape);
  const ShownParts then = shown_parts(heads, wanted_.shape, wanted_.shape);
  return std::ranges::all_of(then.parts, [&](const PixelRect& part) {
    return std::ranges::any_of(now.parts, [&](const PixelRect& known) {
      return known.y == part.y && known.height == part.height && known.x <= part.x &&
             part.x + part.width <= known.x + known.width;
    });
  });
}

void Display::describe(const std::vector<HeadPlan>& heads) {
  std::size_t vertices = 0;
  std::size_t patches = 0;
  std::size_t maps = 0;
  double worst_px = 0.0;
  for (const HeadPlan& head : heads) {
    maps += std::holds_alternative<warp::PixelMap>(head.warp) ? 1U : 0U;
    if (const auto* const mesh = std::get_if<warp::WarpMesh>(&head.warp)) {
      vertices += mesh->vertices.size();
      worst_px = std::max(worst_px, mesh->worst_error_px);
    }
    if (const auto* const patched = std::get_if<warp::WarpPatches>(&head.warp)) {
      patches += patched->patches.size();
      worst_px = std::max(worst_px, patched->worst_error_px);
    }
  }
  inspection_.set_fact("heads", fmt::format("{}", heads.size()));
  inspection_.set_fact("heads_with_pixel_maps", fmt::format("{}", maps));
  inspection_.set_fact("panorama", fmt::format("{}x{} px{}", wanted_.width_px(), height_px(wanted_.shape),
                                               wanted_.stacked() == 2 ? " for each eye" : ""));
  inspection_.set_fact("warp_vertices", fmt::format("{}", vertices));
  inspection_.set_fact("warp_patches", fmt::format("{}", patches));
  inspection_.set_fact("warp_error_px", fmt::format("{:.3f}", worst_px));
  inspection_.set_fact("wall_unlit_percent",
                       fmt::format("{:.2f}", 100.0 * warp::unlit_fraction(options_.installation)));
}

void Display::on_message(wire::ShowMessage message) {
  if (message.message_case() == wire::ShowMessage::MESSAGE_NOT_SET) return;  // Sent by a newer tour; ignored.
  const TimePoint now = clock_.now();
  if (message.has_clock()) {
    if (tour_clock_.take(message.clock(), now)) mailbox_.clock.put(tour_clock_.reading(now));
    return;
  }
  if (message.has_caption()) return take_caption(message.caption());
  if (!message.has_heading()) return assembler_->take(std::move(message));
  const wire::Heading& heading = message.heading();
  // The first message of a stream: what another one has written is over.
  if (heading.has_shown()) write(Caption());
  if (!std::isfinite(heading.heading_rad())) return;
  const ShowAt at = show_at_of(message);
  tour_clock_.heading_ready(at, now);
  HeadingNow pose{heading.heading_rad(), heading.shutter_ns(), at};
  pose.cuts = heading.cuts();
  if (heading.has_eye_m() && from_wire(heading.eye_m()).allFinite()) {
    pose.eye_m = {heading.eye_m().x(), heading.eye_m().y(), heading.eye_m().z()};
  }
  // Heading::shown is not needed: the warps define the wall's extent, and a frame its own shape.
  mailbox_.headings.put(pose);
}

void Display::take_caption(const wire::Caption& message) {
  auto caption = caption_of(message);
  if (!caption) return inspection_.set_fact("caption_refused", caption.error().message());
  write(*std::move(caption));
}

void Display::write(Caption caption) {
  if (caption.ink.empty() && !is_written_to_) return;  // A tour that never writes costs nothing.
  is_written_to_ = true;
  mailbox_.captions.wanted.put(std::make_unique<Caption>(std::move(caption)));
}

void Display::frame_ready(DisplayFrame frame) {
  const int largest = present_->max_side_px();
  if (width_px(frame.shape) > largest || frame.stacked * height_px(frame.shape) > largest) {
    return frame_dropped(frame.number, fmt::format("larger than {} px, the graphics card's maximum", largest));
  }
  tour_clock_.frame_ready(frame.show_at, frame.decoded_at);
  std::unique_ptr<DisplayFrame> unseen;
  {
    // Two decode threads may finish frames at the same time.
    const std::lock_guard lock(mutex_);
    newest_ready_ = std::max(newest_ready_, frame.order);
    mailbox_.is_failing = false;
    history_->frame_ready(frame);
    if (!frame.depth_trouble.empty() && depth_troubles_.size() < kMaxDropsWaiting) {
      depth_troubles_.push_back(frame.depth_trouble);
    }
    unseen = mailbox_.frames.put(std::make_unique<DisplayFrame>(std::move(frame)));
    if (unseen != nullptr) add_drop(unseen->number, kPassedOver);
  }
}

void Display::frame_dropped(std::uint64_t number, const std::string& reason) {
  mailbox_.is_failing = true;
  const std::lock_guard lock(mutex_);
  add_drop(number, reason);
}

void Display::add_drop(std::uint64_t number, const std::string& reason) {
  if (drops_.size() < kMaxDropsWaiting) drops_.push_back({number, reason});
}

void Display::free_shown() {
  mailbox_.captions.replaced.take();
  mailbox_.retired.clear([this](const DisplayFrame& unseen) {
    const std::lock_guard lock(mutex_);
    if (unseen.order > reported_after_) add_drop(unseen.number, kPassedOver);
  });
}

void Display::serve(TimePoint deadline) {
  do {
    free_shown();
    patterns_.tend();
    note_output();
    keep_reach();
    keep_hours();
    keep_calibration();
    keep_connected();
    request_time();
    report_refreshes();
    report_drops();
    serve_watchers();
    publish_state();
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock_.now());
    pollfd entry{present_->event_fd(), POLLIN, 0};
    ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1000)));
    present_->drain();
  } while (clock_.now() < deadline);
}

/// Lights or darkens the heads. The result depends on the present time alone, not on when the process started or the
/// clock was set. Patterns keep the heads awake, since a wall is measured while the museum is closed, and so does help.
void Display::keep_hours() {
  const auto now = wall_time(std::chrono::time_point_cast<WallTime::duration>(options_.system_clock()));
  is_awake_ = patterns_.is_open() || patterns_.has_notice() || hours_.is_open(now);
  inspection_.set_gauge("awake", is_awake_ ? 1.0 : 0.0);
}

/// Shows how to reach the operator page, or the show again.
void Display::keep_reach() {
  if (!reach_ || !reach_->update(clock_.now())) return;
  patterns_.set_notice(reach_->pictures());
  inspection_.set_fact("reach_shown", patterns_.has_notice() ? "yes" : "no");
  inspection_.set_fact("reach_trouble", reach_->trouble());
}

void Display::note_output() {
  const std::unique_ptr<OutputState> state = present_->take_state();
  if (state == nullptr) return;
  loss_ = state->loss;
  if (loss_) reporter_.output_lost();
  inspection_.set_gauge("output_losses", state->losses);
  inspection_.set_fact("output", state->kind);
  inspection_.set_fact("gl_renderer", state->renderer);
  assembler_->set_mesh_cells(is_software_renderer(state->renderer) ? kSoftwareMeshCells : kMeshCells);
}

void Display::keep_connected() {
  if (stream_ != nullptr) {
    if (stream_->is_up()) trouble_.reset();
    const std::optional<Error> end = stream_->end();
    if (!end) return;
    trouble_ = end;
    mailbox_.is_failing = true;
    hang_up();
    connect_at_ = clock_.now() + kReconnectAfter;
  }
  if (clock_.now() < connect_at_) return;
  {
    const std::lock_guard lock(mutex_);
    drops_.clear();  // Drops that belong to one connection have no meaning for the next.
    reported_after_ = newest_ready_;
  }
  stream_ = std::make_unique<ShowStream>(channel_, hello_, [this](wire::ShowMessage m) { on_message(std::move(m)); });
}

void Display::hang_up() {
  stream_.reset();
  assembler_->stream_lost();
  tour_clock_.reset();
  mailbox_.clock.put({});
}

void Display::request_time() {
  if (stream_ == nullptr || !stream_->is_up()) return;
  auto question = tour_clock_.question(clock_.now());
  if (!question) return;
  if (const auto share = reporter_.synchronised_share(clock_.now())) question->set_synchronised_share(*share);
  wire::DisplayReport report;
  *report.mutable_clock() = *std::move(question);
  stream_->report(std::move(report));
}

void Display::report_refreshes() {
  while (const auto event = mailbox_.refreshes.pop()) {
    if (options_.on_refresh) options_.on_refresh(*event);
    history_->refreshed(*event, is_awake_ && !patterns_.is_open() && !patterns_.has_notice() && !event->has_caption);
    if (event->synchronised_refresh) tour_clock_.drawn_ahead(event->drawn_ahead);
    auto presented = reporter_.take(*event);
    if (!presented || stream_ == nullptr || event->frame_order <= reported_after_) continue;
    wire::DisplayReport report;
    *report.mutable_presented() = *std::move(presented);
    stream_->report(std::move(report));
  }
  while (const auto refresh = mailbox_.head_refreshes.pop()) reporter_.take(*refresh);
  reporter_.tick(clock_.now());
}

void Display::report_drops() {
  std::vector<Drop> drops;
  std::vector<std::string> depth_troubles;
  {
    const std::lock_guard lock(mutex_);
    drops.swap(drops_);
    depth_troubles.swap(depth_troubles_);
  }
  for (const std::string& trouble : depth_troubles) reporter_.frame_without_depth(trouble);
  for (Drop& drop : drops) {
    reporter_.frame_dropped(drop.reason);
    if (stream_ == nullptr) continue;
    wire::DisplayReport report;
    report.mutable_dropped()->set_view_number(drop.number);
    report.mutable_dropped()->set_reason(printable(drop.reason, 300));
    stream_->report(std::move(report));
  }
}

void Display::serve_watchers() {
  if (inspection_.is_watched("panorama")) mailbox_.panorama.want([] { return std::make_unique<DisplayFrame>(); });
  if (const std::unique_ptr<DisplayFrame> frame = mailbox_.panorama.take()) {
    inspection_.set_picture("panorama", std::make_shared<const RgbImage>(decoded_parts(*frame, &pictures_)));
  }
  for (std::size_t i = 0; i < mailbox_.heads.size(); ++i) {
    const InstalledProjector& projector = options_.installation.projectors[i];
    const std::string name = "projector/" + projector.name;
    if (inspection_.is_watched(name)) {
      mailbox_.heads[i].want(
          [&] { return std::make_unique<RgbImage>(projector.lens.width_px, projector.lens.height_px); });
    }
    if (auto picture = mailbox_.heads[i].take()) {
      inspection_.set_picture(name, std::shared_ptr<const RgbImage>(std::move(picture)));
    }
  }
}

void Display::publish_state() {
  if (!is_presenting()) {
    inspection_.set_state("The output does not refresh; the graphics driver hangs.", false);
  } else if (loss_) {
    inspection_.set_state(fmt::format("Shows nothing: {}. Opening the output again and again.", loss_->message()),
                          false);
  } else if (patterns_.is_open()) {
    inspection_.set_state("Shows the patterns of a calibration.", true);
  } else if (!is_awake_) {
    inspection_.set_state("Sleeps: the museum is closed.", true);
  } else if (trouble_) {
    inspection_.set_state(
        fmt::format("Holds its last picture: the tour at {} does not answer ({}). Reconnecting without end.",
                    options_.tour, trouble_->message()),
        false);
  } else if (stream_ == nullptr || !stream_->is_up()) {
    inspection_.set_state(fmt::format("Connects to the tour at {}.", options_.tour), false);
  } else {
    inspection_.set_state(
        fmt::format("Shows the tour at {}: {:.1f} frames per second.", options_.tour, reporter_.frames_per_second()) +
            step_sentence() + calibration_sentence(),
        true);
  }
  const auto skew = tour_clock_.skew();
  if (!skew) return;
  inspection_.set_gauge("clock_skew_ms", to_milliseconds(skew->ahead));
  inspection_.set_gauge("clock_error_ms", to_milliseconds(skew->error));
}

std::string Display::calibration_sentence() const {
  return misfit_ ? fmt::format(" The newest calibration is not used: {}.", printable(misfit_->message(), 400)) : "";
}

std::string Display::step_sentence() const {
  const auto share = reporter_.synchronised_share(clock_.now());
  return share ? fmt::format(" It is synchronised with the other displays in {:.2f} % of refreshes.", 100.0 * *share)
               : "";
}

}  // namespace cyclorama::display
