// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/session_admission.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/wire/convert.h"

namespace cyclorama::coordinator {
namespace {

/// Maximum samples of a view with stored light. More would show no difference, and would delay other museums' blocks,
/// because the samples of a cell are traced together.
constexpr std::uint32_t kMaxStoredLightSamples = 64;
/// Maximum path segments of a pixel with adaptive sampling. A cell's samples then depend on each other, so that a node
/// does not interrupt it for other museums' blocks; this many segments take it some tens of milliseconds.
constexpr std::uint64_t kMaxAdaptiveSegments = 512;
constexpr double kMaxBudgetMs = 60000.0;
constexpr std::uint32_t kUsualReference = 1024;
constexpr std::uint32_t kMaxReferenceSamples = 4096;

Error refused(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

Status check_quota(const char* what, std::uint32_t requested, int granted) {
  if (static_cast<std::int64_t>(requested) <= granted) return Done{};
  return refused(fmt::format("view.{} is {}; this museum's grant allows at most {}", what, requested, granted));
}

}  // namespace

Status SessionAdmission::check_view(const Session& session, const wire::View& view) const {
  TRY(validate(view));
  const std::int64_t px = std::int64_t{view.panorama().width_px()} * view.panorama().height_px();
  if (px > max_picture_px_) {
    return refused(fmt::format("view.panorama has {} pixels; this farm renders at most {}", px, max_picture_px_));
  }
  TRY(check_quota("samples", view.samples(), session.grant.samples));
  TRY(check_quota("bounces", view.bounces(), session.grant.bounces));
  if (view.stored_light() && view.samples() > kMaxStoredLightSamples) {
    return refused(
        fmt::format("view.samples is {}; with stored light it is at most {}", view.samples(), kMaxStoredLightSamples));
  }
  const std::uint64_t segments = std::uint64_t{view.samples()} * (1 + std::uint64_t{view.bounces()});
  if (view.adaptive_error() > 0.0f && segments > kMaxAdaptiveSegments) {
    return refused(fmt::format("view.samples times (1 + view.bounces) is {}; with adaptive sampling it is at most {}",
                               segments, kMaxAdaptiveSegments));
  }
  if (view.number() <= session.newest_view) {
    return refused(fmt::format("view.number is {} after {}; it must increase", view.number(), session.newest_view));
  }
  if (view.first_sample() != 0) return refused("view.first_sample is not 0; only the farm refines pictures");
  return Done{};
}

Status SessionAdmission::check_scene_memory(const Session& session, const std::string& scene) const {
  if (session.grant.scene_bytes <= 0.0) return Done{};
  std::set<std::string> open = sessions_.scenes_of(session.account);
  open.insert(scene);
  double bytes = 0.0;
  for (const std::string& name : open) bytes += static_cast<double>(nodes_.memory_of(name));
  if (bytes <= session.grant.scene_bytes) return Done{};
  return Error(ErrorCode::kBusy,
               fmt::format("scene '{}': with it, the scenes of '{}' need {:.2f} GiB; its grant allows {:.2f} GiB",
                           scene, session.museum, bytes / (1 << 30), session.grant.scene_bytes / (1 << 30)));
}

Result<int> SessionAdmission::reference_samples(const Session& session, const wire::OpenSession& open) {
  const double budget_ms = open.frame_budget_ms();
  if (budget_ms == 0.0) return 0;
  if (!(budget_ms > 0.0 && budget_ms <= kMaxBudgetMs)) {
    return refused(fmt::format("open.frame_budget_ms is {}; it must be 0 to {}", budget_ms, kMaxBudgetMs));
  }
  if (open.reference_samples() > kMaxReferenceSamples) {
    return refused(fmt::format("open.reference_samples is {}; it must be at most {}", open.reference_samples(),
                               kMaxReferenceSamples));
  }
  const std::uint32_t samples = open.reference_samples() == 0 ? kUsualReference : open.reference_samples();
  return std::min(static_cast<int>(samples), session.grant.samples);
}

}  // namespace cyclorama::coordinator
