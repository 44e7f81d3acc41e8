// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/presenter.h"

#include <utility>

namespace cyclorama {

Presenter::Presenter(Output* output, WarpProgram program, double shown_span_rad, PresentMailbox* mailbox,
                     const Clock* clock)
    : output_(*output),
      mailbox_(*mailbox),
      clock_(*clock),
      shown_span_rad_(shown_span_rad),
      program_(std::move(program)),
      panorama_(output->gl()) {}

Result<std::unique_ptr<Presenter>> Presenter::make(Output* output, const std::vector<HeadWarp>& warps,
                                                   const Frame& first, double shown_span_rad, PresentMailbox* mailbox,
                                                   const Clock* clock) {
  CHECK(warps.size() == output->heads().size() && mailbox->heads.size() == warps.size());
  TRY_ASSIGN(WarpProgram program, WarpProgram::make(output->gl()));
  std::unique_ptr<Presenter> presenter(new Presenter(output, std::move(program), shown_span_rad, mailbox, clock));
  for (const HeadWarp& warp : warps) {
    TRY_ASSIGN(HeadPainter painter, HeadPainter::make(output->gl(), presenter->program_, warp.mesh, warp.mask));
    presenter->painters_.push_back(std::move(painter));
  }
  presenter->frame_ = first;
  TRY(presenter->panorama_.upload(first));
  return presenter;
}

Status Presenter::refresh() {
  TRY(output_.wait_for_refresh());
  RefreshEvent event;
  event.drawing_at = clock_.now();
  TRY(take_news(&event));
  if (!is_drawn_ || is_any_head_due()) TRY(draw_heads());
  TRY_ASSIGN(event.presented, output_.present());
  event.is_past_guard = shift_.is_past_guard;
  mailbox_.refreshes.push(event);
  return Done{};
}

Status Presenter::take_news(RefreshEvent* ret_event) {
  const std::unique_ptr<Frame> frame = mailbox_.frame.take();
  if (frame != nullptr) {
    TRY(panorama_.upload(*frame));
    frame_ = *frame;
    is_drawn_ = false;
    ret_event->is_first_of_frame = true;
    ret_event->frame_order = frame_.order;
    ret_event->frame_number = frame_.number;
    ret_event->frame_shutter_ns = frame_.shutter_ns;
    ret_event->frame_bytes = frame_.bytes;
    ret_event->begun_at = frame_.begun_at;
    ret_event->decoded_at = frame_.decoded_at;
  }
  const std::unique_ptr<HeadingNow> heading = mailbox_.heading.take();
  if (heading != nullptr) {
    heading_ = *heading;
    has_heading_ = true;
    ret_event->heading_shutter_ns = heading_.shutter_ns;
  }
  // The display's own picture belongs to no heading.
  const bool turns = has_heading_ && frame_.number != 0;
  const YawShift shift =
      turns ? yaw_shift(frame_.panorama, frame_.heading_rad, heading_.heading_rad, shown_span_rad_) : YawShift{};
  if (shift.angle_rad != shift_.angle_rad) is_drawn_ = false;
  shift_ = shift;
  if (mailbox_.panorama.is_due()) {
    mailbox_.panorama.newest.put(std::make_unique<std::shared_ptr<const RgbImage>>(frame_.picture));
  }
  return Done{};
}

Status Presenter::draw_heads() {
  for (std::size_t head = 0; head < painters_.size(); ++head) {
    TRY(output_.draw_to(head));
    painters_[head].draw(panorama_, shift_.angle_rad);
    if (mailbox_.heads[head].is_due()) read_back(head);
  }
  is_drawn_ = true;
  return output_.gl().check("drawing the heads");
}

void Presenter::read_back(std::size_t head) {
  const HeadMode& mode = output_.heads()[head];
  if (read_back_.width() != mode.width_px || read_back_.height() != mode.height_px) {
    read_back_ = RgbaImage(mode.width_px, mode.height_px);
  }
  output_.gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
  output_.gl().ReadPixels(0, 0, mode.width_px, mode.height_px, GL_RGBA, GL_UNSIGNED_BYTE, read_back_.data().data());
  auto picture = std::make_unique<RgbImage>(mode.width_px, mode.height_px);
  to_picture(read_back_, picture.get());
  mailbox_.heads[head].newest.put(std::move(picture));
}

bool Presenter::is_any_head_due() const {
  for (const auto& head : mailbox_.heads) {
    if (head.is_due()) return true;
  }
  return false;
}

}  // namespace cyclorama
