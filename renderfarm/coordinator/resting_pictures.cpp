// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/resting_pictures.h"

#include <algorithm>

#include "renderfarm/coordinator/session_governor.h"

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

}  // namespace

void RestingPictures::leave(Session& session) {
  GovernorState& governed = *session.governed;
  governed.still_since = clock_.now();
  governed.refinement.reset();
  governed.blocks.clear();
  governed.failures = 0;
  governed.retry_at = {};
  if (session.frames.empty() || !session.frames.front().refines) return;
  orders_.give_up(session.frames.front(), "a newer view came", session);
  accounts_.end(session.account, session.frames.front().turn);
  session.views.finish(session.frames.front().view.number());
  session.frames.clear();
}

bool RestingPictures::is_due(const Session& session) const {
  if (!session.governed || session.views.is_waiting() || !session.frames.empty() || session.messages_waiting > 0)
    return false;
  const GovernorState& governed = *session.governed;
  if (!governed.asked || clock_.now() < governed.retry_at || nodes_.count_with(session.scene) == 0) return false;
  return governed.refinement || clock_.now() - governed.still_since >= kStill;
}

void RestingPictures::set_view(const Session& session, FrameInFlight* frame) const {
  const GovernorState& governed = *session.governed;
  const governor::Refinement& refinement = *governed.refinement;
  frame->view = *governed.asked;
  frame->asked_px = std::int64_t{frame->view.panorama().width_px()} * frame->view.panorama().height_px();
  frame->view.set_shutter_ns(0);
  frame->view.clear_depth();  // A picture at rest is never shown from another eye.
  render::PictureQuality quality = refinement.quality();
  quality.render.first_sample = frame->refines->first;
  quality.render.samples = frame->refines->end - frame->refines->first;
  apply(governed, quality, &frame->view);
  lights_.name(session.scene, &frame->view);
  if (governed.light.empty()) return;
  frame->view.set_light(governed.light);
  frame->view.set_prior_samples(static_cast<std::uint32_t>(refinement.prior().samples));
  frame->view.set_prior_weight(static_cast<float>(refinement.prior().weight));
}

std::vector<AssignedBlock> RestingPictures::begin(SessionId id, Session& session) {
  if (!is_due(session)) return {};
  GovernorState& governed = *session.governed;
  if (!governed.refinement) {
    governed.refinement.emplace(governed.governor.front(), governed.governor.current(), governed.reference_samples);
    governed.light = governed.refinement->prior().samples > 0 ? lights_.in_use(session.scene) : "";
  }
  if (!governed.light.empty() && nodes_.count_with_light(session.scene, governed.light) == 0) {
    // The light that the picture began with is gone, so the refinement starts again.
    governed.refinement.reset();
    governed.blocks.clear();
    return {};
  }
  const auto range = governed.refinement->next(governed.ms_per_sample * megapixels(*governed.asked));
  if (!range) return {};
  FrameInFlight& frame = session.frames.emplace_back();
  frame.id = planner_.next_frame();
  frame.refines = range;
  set_view(session, &frame);
  session.views.add(frame.view.number(), {});
  frame.received_at = frame.turn_began_at = frame.planned_at = frame.last_tile_at = clock_.now();
  if (governed.blocks.empty()) {  // The blocks are kept for all refinements.
    governed.blocks = planner_.split(id, session, frame.view, true);
    for (AssignedBlock& block : governed.blocks) block.forecast = {};
  }
  planner_.take_turn(session, &frame);
  const std::vector<NodeId> able = nodes_.able(session.scene, session.account, frame.view.light());
  for (AssignedBlock& block : governed.blocks) {
    if (std::ranges::find(able, block.node) == able.end()) block.node = nodes_.least_loaded(able);
  }
  return governed.blocks;
}

bool RestingPictures::finish(Session& session, const FrameInFlight& frame) {
  GovernorState& governed = *session.governed;
  if (frame.failure) {
    // No part of the picture was sent, so no end will be written.
    session.views.finish(frame.view.number());
    const int doublings = std::min(governed.failures++, kMaxDoublings);
    governed.retry_at = clock_.now() + std::min(kLastRetry, kFirstRetry * (1 << doublings));
    return false;
  }
  governed.failures = 0;
  governed.refinement->done(*frame.refines);
  return true;
}

}  // namespace cyclorama::coordinator
