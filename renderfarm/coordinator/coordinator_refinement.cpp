// SPDX-License-Identifier: Apache-2.0
// Governed sessions: the quality of moving pictures, and the refinement of pictures at rest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/picture_cut.h"
#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

/// A session is at rest after this time without a request, if nothing is on its way. It exceeds a tour's step and a
/// network's round trip, so that no work is wasted between two views of a walk.
constexpr Duration kStill = std::chrono::milliseconds(150);
/// Delay after a refined picture was given up, doubled after each further one, so that a lost node has time to return
/// and a broken one does not keep the farm busy.
constexpr Duration kFirstRetry = std::chrono::seconds(5);
constexpr Duration kLastRetry = std::chrono::seconds(60);
constexpr int kMaxDoublings = 4;  ///< From kFirstRetry to kLastRetry.

/// Returns `px` times `scale`, rounded to a multiple of `cut` and at most `px`.
std::uint32_t scaled(std::uint32_t px, double scale, int cut = kCutPx) {
  if (scale >= 1.0) return px;
  return std::min(px, static_cast<std::uint32_t>(cut * std::max(1.0, std::round(scale * px / cut))));
}

double megapixels(const wire::View& view) {
  return 1e-6 * static_cast<double>(view.panorama().width_px()) * static_cast<double>(view.panorama().height_px());
}

/// Returns `quality` with the number of bounces of the session's pictures.
render::PictureQuality with_bounces(const GovernorState& governed, render::PictureQuality quality) {
  if (!governed.bounces) return quality;
  const auto stated = static_cast<int>(governed.asked->bounces());
  quality.render.bounces = stated > 0 ? stated : *governed.bounces;
  return quality;
}

}  // namespace

void apply(const render::PictureQuality& quality, wire::View* view) {
  view->set_samples(static_cast<std::uint32_t>(quality.render.samples));
  view->set_first_sample(static_cast<std::uint32_t>(quality.render.first_sample));
  view->set_sequence(static_cast<std::uint32_t>(quality.render.sequence));
  view->set_bounces(static_cast<std::uint32_t>(quality.render.bounces));
  view->set_light_samples(static_cast<std::uint32_t>(quality.render.light_samples));
  view->set_firefly_limit(quality.render.firefly_limit);
  view->set_adaptive_error(quality.render.adaptive_error);
  view->set_adaptive_minimum(static_cast<std::uint32_t>(quality.render.adaptive_minimum));
  view->set_stored_light(quality.render.stored_light);
  view->set_denoise(quality.denoise);
  view->set_jpeg_quality(static_cast<std::uint32_t>(quality.jpeg_quality));
  view->set_subsample_chroma(quality.subsample_chroma);
  wire::Panorama& panorama = *view->mutable_panorama();
  panorama.set_width_px(scaled(panorama.width_px(), quality.scale));
  // The two eyes' pictures must meet at a cell boundary.
  panorama.set_height_px(scaled(panorama.height_px(), quality.scale, panorama.has_eyes() ? 2 * kCutPx : kCutPx));
}

void CoordinatorState::govern(GovernorState& governed, FrameInFlight* frame) {
  governed.asked = frame->view;
  const governor::ParetoPoint& point = governed.governor.choose(megapixels(frame->view));
  apply(with_bounces(governed, point.quality), &frame->view);
  // Uses the rendered size, which is rounded to whole cells; the difference matters for small pictures.
  frame->work = point.cost * megapixels(frame->view) / (point.quality.scale * point.quality.scale);
}

void CoordinatorState::learn(GovernorState& governed, const WrittenFrame& frame) {
  const TimePoint now = clock_.now();
  // If two frames are in flight, the later one has the farm to itself only after the earlier one's end.
  const double ms = 1e3 * to_seconds(now - std::max(frame.planned_at, governed.written_at));
  governed.written_at = governed.still_since = now;
  if (frame.reassigned) return;  // Such a frame's time does not reflect its quality.
  if (frame.samples_added > 0) {
    governed.ms_per_sample = ms / (frame.samples_added * frame.megapixels);
  } else {
    governed.governor.measured({frame.work, ms, frame.rays_ms});
  }
}

void CoordinatorState::leave_rest(Session& session) {
  GovernorState& governed = *session.governed;
  governed.still_since = clock_.now();
  governed.refinement.reset();
  governed.blocks.clear();
  governed.failures = 0;
  governed.retry_at = {};
  if (session.frames.empty() || !session.frames.front().refines) return;
  fail(session.frames.front(), "a newer view came", session);
  accounts_.end(session.account, session.frames.front().turn);
  session.views.finish(session.frames.front().view.number());
  session.frames.clear();
}

void CoordinatorState::refine(SessionId id, Session& session) {
  if (!session.governed || session.views.is_waiting() || !session.frames.empty() || session.messages_waiting > 0)
    return;
  GovernorState& governed = *session.governed;
  if (!governed.asked || clock_.now() < governed.retry_at || nodes_with(session.scene) == 0) return;
  if (!governed.refinement) {
    if (clock_.now() - governed.still_since < kStill) return;
    governed.refinement.emplace(governed.governor.front(), governed.governor.current(), governed.reference_samples);
    governed.light = governed.refinement->prior().samples > 0 ? light_in_use(session.scene) : "";
  }
  if (!governed.light.empty() && nodes_with_light(session.scene, governed.light) == 0) {
    // The light that the picture began with is gone, so the refinement starts again.
    governed.refinement.reset();
    governed.blocks.clear();
    return;
  }
  const governor::Refinement& refinement = *governed.refinement;
  const auto range = refinement.next(governed.ms_per_sample * megapixels(*governed.asked));
  if (!range) return;
  FrameInFlight& frame = session.frames.emplace_back();
  frame.id = ++last_frame_;
  frame.refines = range;
  frame.view = *governed.asked;
  frame.asked_px = std::int64_t{frame.view.panorama().width_px()} * frame.view.panorama().height_px();
  frame.view.set_shutter_ns(0);
  frame.view.clear_depth();  // A picture at rest is never shown from another eye.
  render::PictureQuality quality = with_bounces(governed, refinement.quality());
  quality.render.first_sample = range->first;
  quality.render.samples = range->end - range->first;
  apply(quality, &frame.view);
  name_light(session.scene, &frame.view);
  if (!governed.light.empty()) {
    frame.view.set_light(governed.light);
    frame.view.set_prior_samples(static_cast<std::uint32_t>(refinement.prior().samples));
    frame.view.set_prior_weight(static_cast<float>(refinement.prior().weight));
  }
  session.views.add(frame.view.number(), {});
  frame.received_at = frame.turn_began_at = frame.planned_at = frame.last_tile_at = clock_.now();
  if (governed.blocks.empty()) governed.blocks = split(id, session, frame.view, true);  // Kept for all refinements.
  take_turn(session, &frame);
  const std::vector<NodeId> able = nodes_.able(session.scene, session.account, frame.view.light());
  for (AssignedBlock& block : governed.blocks) {
    if (std::ranges::find(able, block.node) == able.end()) block.node = nodes_.least_loaded(able);
  }
  frame.threads = threads_of(governed.blocks);
  for (const AssignedBlock& block : governed.blocks) {
    frame.assembly.plan(++last_block_, block.node, block.rect);
    order_block(id, session, frame, last_block_, block.node, block.rect);
  }
  session.next_due = deadlines_.next_due(session);
}

void CoordinatorState::finish_refined(SessionId id, Session& session, FrameInFlight& frame, const FrameReport& report) {
  GovernorState& governed = *session.governed;
  if (frame.failure) {
    // No part of the picture was sent, so no end will be written.
    session.views.finish(frame.view.number());
    const int doublings = std::min(governed.failures++, kMaxDoublings);
    governed.retry_at = clock_.now() + std::min(kLastRetry, kFirstRetry * (1 << doublings));
    return;
  }
  governed.failures = 0;
  governed.refinement->done(*frame.refines);
  begin(id, session, frame);
  end(id, session, frame, report);
}

std::string CoordinatorState::quality_summary(const Session& session) {
  if (!session.governed || !session.governed->asked) return "";
  const GovernorState& governed = *session.governed;
  if (!governed.refinement) {
    const render::PictureQuality& quality = governed.governor.current().quality;
    return fmt::format("moving, {} sample{} at {:.0f} % of the size", quality.render.samples,
                       quality.render.samples == 1 ? "" : "s", 100.0 * quality.scale);
  }
  const governor::Refinement& refinement = *governed.refinement;
  if (governed.failures > 0) return fmt::format("at rest with {} samples, more failed", refinement.samples());
  if (refinement.rests()) return fmt::format("at rest with {} samples", refinement.samples());
  return fmt::format("refining {} of {} samples", refinement.samples(), refinement.reference_samples());
}

}  // namespace cyclorama::coordinator
