// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/session_governor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/picture_cut.h"

namespace cyclorama::coordinator {
namespace {

/// Returns `px` times `scale`, rounded to a multiple of `cut` and at most `px`.
std::uint32_t scaled(std::uint32_t px, double scale, int cut = kCutPx) {
  if (scale >= 1.0) return px;
  return std::min(px, static_cast<std::uint32_t>(cut * std::max(1.0, std::round(scale * px / cut))));
}

}  // namespace

double megapixels(const wire::View& view) {
  return 1e-6 * static_cast<double>(view.panorama().width_px()) * static_cast<double>(view.panorama().height_px());
}

void apply(const GovernorState& governed, render::PictureQuality quality, wire::View* view) {
  if (governed.bounces) {
    const auto stated = static_cast<int>(governed.asked->bounces());
    quality.render.bounces = stated > 0 ? stated : *governed.bounces;
  }
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

void govern(GovernorState& governed, FrameInFlight* frame) {
  governed.asked = frame->view;
  const governor::ParetoPoint& point = governed.governor.choose(megapixels(frame->view));
  apply(governed, point.quality, &frame->view);
  // Uses the rendered size, which is rounded to whole cells; the difference matters for small pictures.
  frame->work = point.cost * megapixels(frame->view) / (point.quality.scale * point.quality.scale);
}

void learn(GovernorState& governed, const WrittenFrame& frame, TimePoint now) {
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

void change_front(Session& session, std::unique_ptr<GovernorState> fresh) {
  GovernorState& old = *session.governed;
  fresh->asked = std::move(old.asked);
  fresh->written_at = old.written_at;
  fresh->still_since = old.still_since;
  fresh->refinement = old.refinement;
  fresh->light = std::move(old.light);
  fresh->blocks = std::move(old.blocks);
  fresh->failures = old.failures;
  fresh->retry_at = old.retry_at;
  fresh->ms_per_sample = old.ms_per_sample;
  session.governed = std::move(fresh);
}

std::string quality_summary(const Session& session) {
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
