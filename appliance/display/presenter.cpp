// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/presenter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama::display {
namespace {
// Turn of the visitor since the picture was requested, above which the picture counts as wrong. The tour also requests
// views for smaller turns.
constexpr double kSameHeading_rad = 1e-3;
constexpr GLsizei kWarmUpSide_px = 4;
/// Time in which a frame that refines its predecessor replaces it.
constexpr Duration kRefinementFade = std::chrono::milliseconds(300);
constexpr AttractTimes kCut{Duration::zero(), std::chrono::milliseconds(800)};
}  // namespace

Presenter::Presenter(output::Output* output, PictureProgram program, const AttractTimes& times, PresentMailbox* mailbox,
                     const Clock* clock)
    : output_(*output),
      mailbox_(*mailbox),
      clock_(*clock),
      picture_program_(std::move(program)),
      attract_(output->gl(), picture_program_),
      left_(output->gl(), picture_program_),
      fade_(times) {}

Result<std::unique_ptr<Presenter>> Presenter::make(output::Output* output, HeadPlans plans, bool may_change,
                                                   const DisplayFrame& attract, const AttractTimes& times,
                                                   PresentMailbox* mailbox, const Clock* clock) {
  CHECK(plans->size() == output->heads().size() && mailbox->heads.size() == plans->size());
  const output::Gl& gl = output->gl();
  gl.Disable(GL_DITHER);  // The shaders dither.
  // Later plans may need more precise texels than these.
  const Texels texels = may_change ? Texels::kHalves : texels_for(gl, *plans);
  TRY_ASSIGN(PictureProgram program, PictureProgram::make(gl, texels));
  mailbox->stepped_at = clock->now();
  std::unique_ptr<Presenter> presenter(new Presenter(output, std::move(program), times, mailbox, clock));
  TRY_ASSIGN(FrameLight light, FrameLight::make(gl, presenter->picture_program_, texels, mesh_filter_for(gl)));
  presenter->light_.emplace(std::move(light));
  TRY_ASSIGN(presenter->heads_, HeadTransition::make(gl, texels, std::move(plans), &mailbox->plans));
  for (const HeadPainter& painter : presenter->heads_->painters())
    presenter->takes_turns_ = presenter->takes_turns_ || painter.takes_turns();
  presenter->captions_.emplace(gl, presenter->heads_.get(), &mailbox->captions);
  TRY_ASSIGN(presenter->patterns_, PatternShow::make(gl, output->heads(), &mailbox->patterns));
  presenter->step();
  for (const output::HeadMode& mode : output->heads())
    presenter->read_backs_.emplace_back(gl, mode.width_px, mode.height_px);
  presenter->attract_frame_ = attract;
  TRY(presenter->warm_up(may_change));
  return presenter;
}

/// Makes the driver compile all shaders now, since otherwise it compiles a shader at its first use, in front of a
/// visitor. Only a few pixels are drawn: 36 whole pictures of a head take a second on a software renderer, and minutes
/// on an emulated processor.
Status Presenter::warm_up(bool may_change) {
  TRY(attract_.upload(attract_frame_));
  TRY(light_->warm_up(attract_frame_.shape));
  TRY(light_->take(attract_frame_));
  output_.gl().Enable(GL_SCISSOR_TEST);
  output_.gl().Scissor(0, 0, kWarmUpSide_px, kWarmUpSide_px);
  for (std::size_t head = 0; head < heads_->count(); ++head) {
    TRY(output_.draw_to(head));
    heads_->warm_up(head, {&light_->panorama(), 0.0}, {&attract_, 0.0}, may_change, [this] { step(); });
  }
  output_.gl().Disable(GL_SCISSOR_TEST);
  output_.gl().Finish();
  return output_.gl().check("trying the shaders");
}

void Presenter::step() {
  const TimePoint now = clock_.now();
  mailbox_.max_step = std::max(mailbox_.max_step.load(), now - mailbox_.stepped_at.load());
  mailbox_.stepped_at = now;
}

Presenter::~Presenter() {
  for (std::size_t head = 0; head < read_backs_.size(); ++head) {
    if (std::unique_ptr<RgbImage> watched = read_backs_[head].cancel())
      mailbox_.heads[head].put_back(std::move(watched));
  }
}

Status Presenter::go_on_with(PresenterState showing) {
  frame_ = std::move(showing.frame);
  waiting_ = std::move(showing.waiting);
  heading_ = showing.heading;
  headings_ = showing.headings;
  fade_ = showing.fade;
  patterns_->go_on_with(std::move(showing.patterns));
  captions_->go_on_with(std::move(showing.caption));
  return frame_ == nullptr ? Status(Done{}) : light_->take(*frame_);
}

Status Presenter::refresh() {
  TRY(output_.wait_for_refresh());
  step();
  RefreshEvent event;
  event.drawing_at = clock_.now();
  take_in();
  shared_.begin(event.drawing_at);
  TRY(show_due_frame(&event));
  turn_to_due_heading(&event);
  TRY(move_to_due_eye(&event));
  TRY(fade_in(&event));
  const bool is_wrong = shift_.is_past_guard || std::abs(shift_.angle_rad) > kSameHeading_rad || mailbox_.is_failing;
  fade_.step(event.drawing_at, event.is_first_of_frame, is_wrong);
  if (cut_) cut_->step(event.drawing_at, true, false);
  if (fade_.share() != drawn_share_ || cut_) is_drawn_ = false;
  event.cut_share = cut_ ? cut_->share() : 0.0;
  if (event.cut_share == 0.0) cut_.reset();
  if (std::unique_ptr<DisplayFrame> watched = mailbox_.panorama.take_empty()) {
    *watched = frame_ != nullptr ? *frame_ : attract_frame_;
    mailbox_.panorama.give(std::move(watched));
  }
  TRY_ASSIGN(const bool has_changed, heads_->step(event.drawing_at, frame_ == nullptr ? 0 : frame_->order));
  TRY_ASSIGN(const bool is_written_anew, captions_->step(event.drawing_at));
  if (patterns_->take() || has_changed || is_written_anew) is_drawn_ = false;
  event.has_caption = captions_->shown() != nullptr;
  if (patterns_->is_open()) {
    TRY(draw_patterns());
  } else if (!is_drawn_ || takes_turns_ || is_any_head_watched()) {
    TRY(draw_heads());
  }
  event.drawn_at = clock_.now();
  TRY_ASSIGN(event.presented, output_.present());
  answer_watchers();
  step();
  shared_.shown(event.presented, output_.refresh_hz());
  patterns_->presented(event.presented, output_.shown());
  event.is_past_guard = shift_.is_past_guard;
  event.attract_share = drawn_share_;
  event.synchronised_refresh = shared_.number();
  event.drawn_ahead = shared_.drawn_ahead();
  mailbox_.refreshes.push(event);
  report_heads();
  notice_depths();
  return Done{};
}

/// Adapts to the bit depths of the outputs, since the device on a connector may change at any time.
void Presenter::notice_depths() {
  for (std::size_t head = 0; head < heads_->count(); ++head) {
    const output::HeadShown& shown = output_.shown()[head];
    if (shown.light == output::HeadShown::Light::kDark || shown.depth_bits == heads_->depth_bits(head)) continue;
    heads_->set_depth(head, shown.depth_bits);
    is_drawn_ = false;
  }
}

void Presenter::report_heads() {
  HeadRefresh told;
  if (frame_ != nullptr && drawn_share_ < 1.0 && !patterns_->is_open())
    told.picture_at = frame_->shutter_ns != 0 ? from_nanoseconds(frame_->shutter_ns) : frame_->begun_at;
  for (told.head = 0; told.head < heads_->count(); ++told.head) {
    told.shown = output_.shown()[told.head];
    mailbox_.head_refreshes.push(told);
  }
}

void Presenter::take_in() {
  if (ClockReading clock; mailbox_.clock.take(&clock)) shared_.set_clock(clock);
  if (mailbox_.headings.take(&headings_)) shared_.learn(headings_.headings.front().show_at);
  for (std::unique_ptr<DisplayFrame>& position : waiting_) {
    if (position == nullptr) position = mailbox_.frames.take();
    if (position != nullptr && position->order > newest_taken_) {
      newest_taken_ = position->order;
      shared_.learn(position->show_at);
    }
  }
}

Status Presenter::show_due_frame(RefreshEvent* ret_event) {
  const std::uint64_t shown = frame_ == nullptr ? 0 : frame_->order;
  std::unique_ptr<DisplayFrame>* next = nullptr;
  for (std::unique_ptr<DisplayFrame>& frame : waiting_) {
    if (frame == nullptr || frame->order < shown || !shared_.is_due(frame->show_at)) continue;
    if (next == nullptr || frame->order > (*next)->order) next = &frame;
  }
  const std::uint64_t newest = next == nullptr ? shown : (*next)->order;
  const auto is_passed_over = [newest](const auto& frame) { return frame != nullptr && frame->order < newest; };
  // If nothing frees retired frames, the last picture stays.
  if (mailbox_.retired.room() <= static_cast<std::size_t>(std::ranges::count_if(waiting_, is_passed_over))) {
    return Done{};
  }
  if (next != nullptr) ret_event->frame_due = (*next)->show_at;
  for (std::unique_ptr<DisplayFrame>& frame : waiting_) {
    if (!is_passed_over(frame)) continue;
    // The delay counts from the refresh at which the first of these frames was due, whichever frame is visible now.
    if (frame->order > shown && frame->show_at.period_ns == ret_event->frame_due.period_ns) {
      ret_event->frame_due.refresh = std::min(ret_event->frame_due.refresh, frame->show_at.refresh);
    }
    mailbox_.retired.put(std::move(frame));
  }
  if (next == nullptr) return Done{};
  if (frame_ != nullptr && (*next)->cuts != frame_->cuts) TRY(leave_place());
  TRY(light_->take(**next));
  std::unique_ptr<DisplayFrame> old = std::exchange(frame_, std::move(*next));
  if (old != nullptr) mailbox_.retired.put(std::move(old));
  moved_.setZero();
  fade_began_ = ret_event->drawing_at;
  frame_->was_shown = true;
  is_drawn_ = false;
  ret_event->is_first_of_frame = true;
  ret_event->frame_order = frame_->order;
  ret_event->frame_number = frame_->number;
  ret_event->frame_shutter_ns = frame_->shutter_ns;
  ret_event->frame_bytes = frame_->bytes;
  ret_event->frame_tiles = frame_->tiles;
  ret_event->frame_decoded = frame_->decoded;
  ret_event->begun_at = frame_->begun_at;
  ret_event->decoded_at = frame_->decoded_at;
  return Done{};
}

Status Presenter::leave_place() {
  TRY(left_.upload(*frame_));
  left_turn_rad_ = shift_.angle_rad;
  light_->forget();
  cut_.emplace(kCut);
  return Done{};
}

void Presenter::turn_to_due_heading(RefreshEvent* ret_event) {
  for (std::size_t i = 0; i < headings_.count; ++i) {
    const HeadingNow& heading = headings_.headings[i];
    if (heading.order <= heading_.order) break;
    if (!shared_.is_due(heading.show_at) || (frame_ != nullptr && heading.cuts != frame_->cuts)) continue;
    heading_ = heading;
    ret_event->heading_shutter_ns = heading.shutter_ns;
    ret_event->heading_due = heading.show_at;
    break;
  }
  ret_event->heading_rad = heading_.heading_rad;
  const bool is_of_frame = heading_.order > 0 && frame_ != nullptr && heading_.cuts == frame_->cuts;
  const YawShift shift =
      is_of_frame ? yaw_shift(frame_->heading_rad, heading_.heading_rad, frame_->turn_limit_rad) : YawShift{};
  if (shift.angle_rad != shift_.angle_rad) is_drawn_ = false;
  shift_ = shift;
  ret_event->turn_rad = shift.angle_rad;
}

/// Draws the frame's light again for each position of the visitor; at the frame's own eye, shows it exactly as
/// received.
Status Presenter::move_to_due_eye(RefreshEvent* ret_event) {
  if (frame_ == nullptr) return Done{};
  ret_event->eye_m = frame_->eye_m;
  if (!heading_.eye_m || heading_.cuts != frame_->cuts) return Done{};
  const Eigen::Vector3d eye_now(heading_.eye_m->data());
  EyeMove move = eye_move(frame_->eye_m, frame_->heading_rad, eye_now);
  if (frame_->mesh == nullptr) move = {Eigen::Vector3d::Zero(), move.eye_m.norm() + move.missed_m};
  if (!move.eye_m.isZero(0.0)) ret_event->eye_m = eye_now;
  ret_event->moved_m = move.eye_m.norm();
  ret_event->missed_m = move.missed_m;
  if (move.eye_m == moved_) return Done{};
  moved_ = move.eye_m;
  is_drawn_ = false;
  return light_->move(*frame_, moved_);
}

Status Presenter::fade_in(RefreshEvent* ret_event) {
  if (!light_->is_fading()) return Done{};
  is_drawn_ = false;
  TRY(light_->fade(to_seconds(ret_event->drawing_at - fade_began_) / to_seconds(kRefinementFade)));
  ret_event->is_fading_in = light_->is_fading();
  return Done{};
}

Status Presenter::draw_heads() {
  const double share = fade_.share();
  const Eye now = eye_at(shared_.coming());
  const TurnedPicture shown{&light_->panorama(), shift_.angle_rad};
  const TurnedPicture attract{&attract_, 0.0};  // The attract picture belongs to no heading.
  const bool is_cut = cut_ && share == 0.0;     // Two pictures are mixed at most.
  const TurnedPicture other = is_cut ? TurnedPicture{&left_, left_turn_rad_} : attract;
  std::optional<ShownCaption> caption;
  if (const ShownCaption* const written = captions_->shown()) {
    caption = *written;
    caption->share *= 1.0 - share;  // It belongs to the visit, as the picture does.
  }
  for (std::size_t head = 0; head < heads_->count(); ++head) {
    TRY(output_.draw_to(head));
    heads_->draw(head, shown, other, is_cut ? cut_->share() : share, now, caption ? &*caption : nullptr);
    show_watcher(head);
    step();
  }
  drawn_share_ = share;
  is_drawn_ = true;
  return output_.gl().check("drawing the heads");
}

Status Presenter::draw_patterns() {
  for (std::size_t head = 0; head < heads_->count(); ++head) {
    if (!patterns_->needs_drawing(head) && !mailbox_.heads[head].is_wanted()) continue;
    TRY(output_.draw_to(head));
    patterns_->draw(head);
    show_watcher(head);
    step();
  }
  return output_.gl().check("drawing patterns");
}

void Presenter::show_watcher(std::size_t head) {
  if (read_backs_[head].is_reading()) return;
  if (std::unique_ptr<RgbImage> watched = mailbox_.heads[head].take_empty())
    read_backs_[head].begin(std::move(watched));
}

void Presenter::answer_watchers() {
  for (std::size_t head = 0; head < read_backs_.size(); ++head) {
    if (std::unique_ptr<RgbImage> watched = read_backs_[head].step()) mailbox_.heads[head].give(std::move(watched));
  }
}

bool Presenter::is_any_head_watched() const {
  return std::ranges::any_of(mailbox_.heads, [](const auto& head) { return head.is_wanted(); });
}

}  // namespace cyclorama::display
