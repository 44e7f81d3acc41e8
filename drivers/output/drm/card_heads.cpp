// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/card_heads.h"

#include <drm_fourcc.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "drivers/output/drm/pipe_plan.h"

namespace cyclorama::output {
namespace {

constexpr int kDeepBits = 10;
constexpr const char* kInFence = "IN_FENCE_FD";
constexpr auto kModesetTimeout = std::chrono::seconds(10);

/// Heads whose rates differ by less than this flip together, such as 59.94 and 59.95 Hz.
bool is_same_rate(double a_hz, double b_hz) {
  constexpr double kSameRate_hz = 0.02;
  return std::abs(a_hz - b_hz) < kSameRate_hz;
}

std::uint32_t format_of(bool is_deep) { return is_deep ? DRM_FORMAT_XRGB2101010 : DRM_FORMAT_XRGB8888; }

ModePreference mode_preference_of(const HeadTarget& target) {
  const bool is_aside = target.rotation == Rotation::kQuarter || target.rotation == Rotation::kThreeQuarters;
  const int width = target.canvas->width_px();
  const int height = target.canvas->height_px();
  return {is_aside ? height : width, is_aside ? width : height, target.refresh_hz};
}

/// True if the card rejected only this setting, so that another setting may work.
bool is_refusal(const Error& error) {
  const int why = error.errno_value();
  return why == EINVAL || why == ENOSPC || why == ERANGE || why == E2BIG || why == EOPNOTSUPP;
}

}  // namespace

std::vector<CardHeads::Setting> CardHeads::settings_for(const HeadTarget& target, std::size_t plane) const {
  const bool can_be_deep =
      target.connector->colour_bits() >= kDeepBits && card_.planes()[plane].can_show(format_of(true));
  std::vector<Setting> settings;
  for (const drmModeModeInfo& mode : modes_to_try(target.connector->modes, mode_preference_of(target))) {
    if (can_be_deep) settings.push_back({mode, true});
    settings.push_back({mode, false});
  }
  return settings;
}

std::optional<std::size_t> CardHeads::primary_plane_of(std::size_t crtc, std::span<const Pipe> others) const {
  for (std::size_t i = 0; i < card_.planes().size(); ++i) {
    const DrmPlane& plane = card_.planes()[i];
    const bool is_taken = std::any_of(others.begin(), others.end(), [&](const Pipe& p) { return p.plane == i; });
    if (plane.is_primary && (plane.possible_crtcs >> crtc & 1U) != 0 && !is_taken) return i;
  }
  return std::nullopt;
}

Result<CardHeads::Pipe> CardHeads::make_pipe(const GpuContext& gpu, const HeadTarget& target, std::size_t crtc,
                                             std::size_t plane, const Setting& setting) {
  Pipe pipe;
  pipe.crtc = crtc;
  pipe.plane = plane;
  pipe.connector_id = target.connector->id();
  pipe.setting = setting;
  TRY_ASSIGN(pipe.mode, ModeBlob::create(card_, setting.mode));
  for (Scanout& buffer : pipe.buffers) {
    TRY_ASSIGN(buffer,
               Scanout::make(gpu, card_, setting.mode.hdisplay, setting.mode.vdisplay, format_of(setting.is_deep)));
  }
  return pipe;
}

Status CardHeads::add_pipe(const GpuContext& gpu, std::span<const Connector> connectors, const HeadTarget& target,
                           std::size_t crtc) {
  const std::optional<std::size_t> plane = primary_plane_of(crtc, pipes_);
  if (!plane) return Done{};
  for (const Setting& setting : settings_for(target, *plane)) {
    const auto kept = std::find_if(retired_.begin(), retired_.end(), [&](const Pipe& p) {
      return p.connector_id == target.connector->id() && p.crtc == crtc && p.plane == *plane &&
             p.setting.is_deep == setting.is_deep && is_same_mode(p.setting.mode, setting.mode);
    });
    if (kept != retired_.end()) {
      pipes_.push_back(std::move(*kept));
      retired_.erase(kept);
    } else {
      TRY_ASSIGN(Pipe made, make_pipe(gpu, target, crtc, *plane, setting));
      pipes_.push_back(std::move(made));
    }
    Pipe& pipe = pipes_.back();
    // A kept pipe may get the picture of another head, whose projector was plugged into its connector.
    pipe.is_drawn = pipe.is_drawn || pipe.target.head != target.head;
    pipe.target = target;
    pipe.connector_text = target.connector->name;
    if (target.connector->edid) pipe.connector_text += " " + target.connector->edid->text();
    if (!target.connector->edid_fault.empty())
      pipe.connector_text += fmt::format(" ({})", target.connector->edid_fault);
    auto tested = set_up(connectors, false).test_modeset(card_);
    if (tested || !is_refusal(tested.error())) return tested;
    retired_.push_back(std::move(pipes_.back()));
    pipes_.pop_back();
  }
  return Done{};
}

AtomicRequest CardHeads::set_up(std::span<const Connector> connectors, bool skips_kept) const {
  AtomicRequest request;
  const auto pipe_where = [&](auto is_it) {
    const auto found = std::find_if(pipes_.begin(), pipes_.end(), is_it);
    return found == pipes_.end() ? nullptr : &*found;
  };
  const auto is_skipped = [&](const Pipe* pipe) { return skips_kept && pipe != nullptr && !pipe->is_new; };
  // With `skips_kept`, what is off and stays off is not touched either: a commit that sends events may not include it.
  const auto was_lit = [&](std::uint32_t crtc_id) {
    return std::find(lit_crtcs_.begin(), lit_crtcs_.end(), crtc_id) != lit_crtcs_.end();
  };
  for (const Connector& connector : connectors) {
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.connector_id == connector.id(); });
    if (is_skipped(pipe)) continue;
    request.set(connector.properties, "CRTC_ID", pipe == nullptr ? 0 : crtc_id(*pipe));
    if (pipe == nullptr) continue;
    request.set_if_known(connector.properties, "link-status", DRM_MODE_LINK_STATUS_GOOD);
    if (pipe->setting.is_deep) request.set(connector.properties, "max bpc", kDeepBits);
  }
  for (std::size_t i = 0; i < card_.crtcs().size(); ++i) {
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.crtc == i; });
    if (is_skipped(pipe) || (skips_kept && pipe == nullptr && !was_lit(card_.crtcs()[i].id()))) continue;
    request.set(card_.crtcs()[i].properties, "MODE_ID", pipe == nullptr ? 0 : pipe->mode.id());
    request.set(card_.crtcs()[i].properties, "ACTIVE", pipe == nullptr ? 0 : 1);
  }
  for (std::size_t i = 0; i < card_.planes().size(); ++i) {
    const Properties& plane = card_.planes()[i].properties;
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.plane == i; });
    if (is_skipped(pipe)) continue;
    // Clears other planes too, such as another program's cursor or the console's text.
    request.set(plane, "FB_ID", pipe == nullptr ? 0 : pipe->back().kms_framebuffer());
    request.set(plane, "CRTC_ID", pipe == nullptr ? 0 : crtc_id(*pipe));
    if (pipe == nullptr) continue;
    const std::uint64_t width = pipe->setting.mode.hdisplay;
    const std::uint64_t height = pipe->setting.mode.vdisplay;
    request.set(plane, "SRC_X", 0);
    request.set(plane, "SRC_Y", 0);
    request.set(plane, "SRC_W", width << 16);  // 16.16 fixed point.
    request.set(plane, "SRC_H", height << 16);
    request.set(plane, "CRTC_X", 0);
    request.set(plane, "CRTC_Y", 0);
    request.set(plane, "CRTC_W", width);
    request.set(plane, "CRTC_H", height);
  }
  return request;
}

Status CardHeads::light(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
                        std::span<const HeadTarget> targets, bool may_block) {
  CHECK(can_light());
  for (Pipe& pipe : retired_) pipe.is_new = true;
  std::move(pipes_.begin(), pipes_.end(), std::back_inserter(retired_));
  pipes_.clear();
  auto lit = light_anew(gpu, copier, connectors, targets, may_block);
  is_known_ = lit.has_value();
  if (lit) return lit;
  std::move(pipes_.begin(), pipes_.end(), std::back_inserter(retired_));
  pipes_.clear();
  return lit;
}

Status CardHeads::light_anew(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
                             std::span<const HeadTarget> targets, bool may_block) {
  for (Pipe& pipe : retired_) {
    const auto same = [&](const Connector& c) { return c.id() == pipe.connector_id; };
    const auto connector = std::find_if(connectors.begin(), connectors.end(), same);
    pipe.is_new = !is_known_ || pipe.is_new || connector == connectors.end() || connector->is_link_bad;
  }
  std::vector<std::uint32_t> possible;
  std::vector<std::optional<std::size_t>> keep;
  for (const HeadTarget& target : targets) {
    // Bits beyond the card's CRTCs mean nothing.
    possible.push_back(target.connector->possible_crtcs &
                       static_cast<std::uint32_t>((1ULL << card_.crtcs().size()) - 1));
    const auto was = std::find_if(retired_.begin(), retired_.end(),
                                  [&](const Pipe& p) { return p.connector_id == target.connector->id(); });
    keep.push_back(was == retired_.end() ? std::nullopt : std::optional(was->crtc));
  }
  const std::vector<std::optional<std::size_t>> crtcs = assign_crtcs(possible, keep);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (crtcs[i] && *crtcs[i] < card_.crtcs().size()) TRY(add_pipe(gpu, connectors, targets[i], *crtcs[i]));
  }
  bool has_new = false;
  for (Pipe& pipe : pipes_) {
    if (!pipe.is_new) continue;
    paint(copier, &pipe);
    has_new = true;
  }
  if (has_new) gpu.gl().Finish();
  return commit_changes(connectors, may_block);
}

Status CardHeads::commit_changes(std::span<const Connector> connectors, bool may_block) {
  std::vector<std::uint32_t> lit;
  std::vector<std::uint32_t> changed;
  for (const Pipe& pipe : pipes_) {
    lit.push_back(crtc_id(pipe));
    if (pipe.is_new) changed.push_back(crtc_id(pipe));
  }
  for (const std::uint32_t id : lit_crtcs_) {
    if (std::find(lit.begin(), lit.end(), id) == lit.end()) changed.push_back(id);
  }
  if (!is_known_ || may_block) {
    waiter_.cancel_all();
    TRY(set_up(connectors, false).commit_modeset(card_));
    retired_.clear();
  } else if (!changed.empty()) {
    void* const cookie = waiter_.expect(changed, clock_.now() + kModesetTimeout);
    if (auto committed = set_up(connectors, true).start_modeset(card_, cookie); !committed) {
      waiter_.cancel(cookie);
      return committed;
    }
  }
  lit_crtcs_ = std::move(lit);
  const bool has_blocked = !is_known_ || may_block;
  for (Pipe& pipe : pipes_) {
    if (!pipe.is_new && !has_blocked) continue;
    pipe.front = 1 - pipe.front;
    pipe.is_settling = !has_blocked;
    pipe.is_painted = pipe.is_drawn = pipe.is_new = false;
  }
  return Done{};
}

void CardHeads::release() {
  pipes_.clear();
  retired_.clear();
}

bool CardHeads::is_showing(std::size_t head) const {
  return std::any_of(pipes_.begin(), pipes_.end(), [&](const Pipe& p) { return p.target.head == head; });
}

std::vector<std::uint32_t> CardHeads::lit_connectors() const {
  std::vector<std::uint32_t> ids;
  for (const Pipe& pipe : pipes_) ids.push_back(pipe.connector_id);
  return ids;
}

double CardHeads::refresh_hz() const {
  double fastest = 0.0;
  for (const Pipe& pipe : pipes_) {
    if (!pipe.is_settling) fastest = std::max(fastest, pipe.refresh_hz());
  }
  return fastest;
}

HeadShown CardHeads::shown(std::size_t head) const {
  for (const Pipe& pipe : pipes_) {
    if (pipe.target.head != head || pipe.is_settling) continue;
    const std::optional<Flipped> flipped = waiter_.flipped(crtc_id(pipe));
    return {flipped ? HeadShown::Light::kNew : HeadShown::Light::kSame, flipped.value_or(Flipped{}).at,
            pipe.refresh_hz(), pipe.setting.is_deep ? kDeepBits : 8};
  }
  return {};
}

std::string CardHeads::text_of_head(std::size_t head) const {
  for (const Pipe& pipe : pipes_) {
    if (pipe.target.head != head) continue;
    return fmt::format("{}, {}, {} bit", pipe.connector_text, text_of(pipe.setting.mode),
                       pipe.setting.is_deep ? kDeepBits : 8);
  }
  return "dark";
}

Status CardHeads::begin() {
  waiter_.clear();
  if (waiter_.is_waiting()) TRY(waiter_.take_events(card_, clock_.now()));
  if (waiter_.is_overdue())
    return Error(ErrorCode::kTimedOut, fmt::format("'{}' did not flip in time", card_.path().string()));
  for (Pipe& pipe : pipes_) pipe.is_settling = pipe.is_settling && waiter_.is_waiting_for(crtc_id(pipe));
  // Until a modeset is complete, the card may scan out the buffers that it replaces.
  if (is_known_ && !waiter_.is_waiting()) retired_.clear();
  return Done{};
}

void CardHeads::draw(std::size_t head) {
  for (Pipe& pipe : pipes_) {
    if (pipe.target.head == head) pipe.is_drawn = true;
  }
}

void CardHeads::paint(const CanvasCopier& copier, Pipe* pipe) {
  copier.copy(*pipe->target.canvas, pipe->target.rotation,
              {pipe->back().gl_framebuffer(), pipe->setting.mode.hdisplay, pipe->setting.mode.vdisplay});
  pipe->is_painted = true;
  pipe->is_drawn = false;
}

void CardHeads::paint(const CanvasCopier& copier, double fastest_hz, bool holds_slower) {
  const bool is_settling = std::any_of(pipes_.begin(), pipes_.end(), [](const Pipe& p) { return p.is_settling; });
  for (Pipe& pipe : pipes_) {
    if (!pipe.is_drawn || waiter_.is_waiting_for(crtc_id(pipe))) continue;
    if (holds_slower && !is_settling && !is_same_rate(pipe.refresh_hz(), fastest_hz)) continue;
    paint(copier, &pipe);
  }
}

bool CardHeads::is_painted() const {
  return std::any_of(pipes_.begin(), pipes_.end(), [](const Pipe& p) { return p.is_painted; });
}

bool CardHeads::takes_fences() const {
  return std::all_of(pipes_.begin(), pipes_.end(),
                     [&](const Pipe& pipe) { return card_.planes()[pipe.plane].properties.find(kInFence) != nullptr; });
}

Status CardHeads::flip(int fence, std::chrono::milliseconds timeout) {
  const bool is_settling = std::any_of(pipes_.begin(), pipes_.end(), [](const Pipe& p) { return p.is_settling; });
  for (const Pipe& first : pipes_) {
    if (!first.is_painted) continue;
    const auto is_with_first = [&](const Pipe& p) {
      return p.is_painted && is_same_rate(p.refresh_hz(), first.refresh_hz());
    };
    AtomicRequest request;
    std::vector<std::uint32_t> crtcs;
    for (const Pipe& pipe : pipes_) {
      if (!is_with_first(pipe)) continue;
      const Properties& plane = card_.planes()[pipe.plane].properties;
      request.set(plane, "FB_ID", pipe.back().kms_framebuffer());
      if (fence >= 0) request.set(plane, kInFence, static_cast<std::uint64_t>(fence));
      crtcs.push_back(crtc_id(pipe));
    }
    void* const cookie = waiter_.expect(crtcs, clock_.now() + timeout);
    if (auto committed = request.commit_flip(card_, cookie); !committed) {
      waiter_.cancel(cookie);
      // Some drivers put all heads into a modeset, and refuse flips of any until it is complete.
      if (is_settling && committed.error().errno_value() == EBUSY) return Done{};
      return committed;
    }
    for (Pipe& pipe : pipes_) {
      if (std::find(crtcs.begin(), crtcs.end(), crtc_id(pipe)) == crtcs.end()) continue;
      pipe.front = 1 - pipe.front;
      pipe.is_painted = false;
    }
  }
  return Done{};
}

Result<std::optional<Flipped>> CardHeads::wait(double refresh_hz) {
  const auto is_awaited = [&](const Pipe& p) {
    return !p.is_settling && is_same_rate(p.refresh_hz(), refresh_hz) && waiter_.is_waiting_for(crtc_id(p));
  };
  while (std::any_of(pipes_.begin(), pipes_.end(), is_awaited)) {
    TRY(waiter_.take_events(card_, waiter_.next_deadline()));
    if (waiter_.is_overdue())
      return Error(ErrorCode::kTimedOut, fmt::format("'{}' did not flip in time", card_.path().string()));
  }
  std::optional<Flipped> last;
  for (const Pipe& pipe : pipes_) {
    const std::optional<Flipped> flipped = waiter_.flipped(crtc_id(pipe));
    if (!flipped || !is_same_rate(pipe.refresh_hz(), refresh_hz)) continue;
    if (!last || last->at < flipped->at) last = flipped;
  }
  return last;
}

}  // namespace cyclorama::output
