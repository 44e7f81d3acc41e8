// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/card_heads.h"

#include <drm_fourcc.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>

#include "drivers/output/drm/pipe_plan.h"

namespace cyclorama::output {
namespace {

constexpr int kDeepBits = 10;

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
    pipe.target = target;
    pipe.connector_text = target.connector->name;
    if (target.connector->edid) pipe.connector_text += " " + target.connector->edid->text();
    auto tested = whole_card(connectors, pipes_).test_modeset(card_);
    if (tested || !is_refusal(tested.error())) return tested;
    retired_.push_back(std::move(pipes_.back()));
    pipes_.pop_back();
  }
  return Done{};
}

AtomicRequest CardHeads::whole_card(std::span<const Connector> connectors, std::span<const Pipe> pipes) const {
  AtomicRequest request;
  const auto pipe_where = [&](auto is_it) {
    const auto found = std::find_if(pipes.begin(), pipes.end(), is_it);
    return found == pipes.end() ? nullptr : &*found;
  };
  for (const Connector& connector : connectors) {
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.connector_id == connector.id(); });
    request.set(connector.properties, "CRTC_ID", pipe == nullptr ? 0 : card_.crtcs()[pipe->crtc].id());
    if (pipe == nullptr) continue;
    request.set_if_known(connector.properties, "link-status", DRM_MODE_LINK_STATUS_GOOD);
    if (pipe->setting.is_deep) request.set(connector.properties, "max bpc", kDeepBits);
  }
  for (std::size_t i = 0; i < card_.crtcs().size(); ++i) {
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.crtc == i; });
    request.set(card_.crtcs()[i].properties, "MODE_ID", pipe == nullptr ? 0 : pipe->mode.id());
    request.set(card_.crtcs()[i].properties, "ACTIVE", pipe == nullptr ? 0 : 1);
  }
  for (std::size_t i = 0; i < card_.planes().size(); ++i) {
    const Properties& plane = card_.planes()[i].properties;
    const Pipe* const pipe = pipe_where([&](const Pipe& p) { return p.plane == i; });
    // Clears other planes too, such as another program's cursor or the console's text.
    request.set(plane, "FB_ID", pipe == nullptr ? 0 : pipe->back().kms_framebuffer());
    request.set(plane, "CRTC_ID", pipe == nullptr ? 0 : card_.crtcs()[pipe->crtc].id());
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
                        std::span<const HeadTarget> targets) {
  waiter_.cancel();
  std::move(pipes_.begin(), pipes_.end(), std::back_inserter(retired_));
  pipes_.clear();
  auto lit = light_anew(gpu, copier, connectors, targets);
  if (lit) {
    retired_.clear();
  } else {
    std::move(pipes_.begin(), pipes_.end(), std::back_inserter(retired_));
    pipes_.clear();
  }
  return lit;
}

Status CardHeads::light_anew(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
                             std::span<const HeadTarget> targets) {
  std::vector<std::uint32_t> possible;
  std::vector<std::optional<std::size_t>> keep;
  for (const HeadTarget& target : targets) {
    possible.push_back(target.connector->possible_crtcs);
    const auto was = std::find_if(retired_.begin(), retired_.end(),
                                  [&](const Pipe& p) { return p.connector_id == target.connector->id(); });
    keep.push_back(was == retired_.end() ? std::nullopt : std::optional(was->crtc));
  }
  const std::vector<std::optional<std::size_t>> crtcs = assign_crtcs(possible, keep);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (crtcs[i] && *crtcs[i] < card_.crtcs().size()) TRY(add_pipe(gpu, connectors, targets[i], *crtcs[i]));
  }
  for (Pipe& pipe : pipes_) paint(copier, &pipe);
  gpu.gl().Finish();
  TRY(whole_card(connectors, pipes_).commit_modeset(card_));
  for (Pipe& pipe : pipes_) {
    pipe.front = 1 - pipe.front;
    pipe.is_painted = false;
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

double CardHeads::refresh_hz() const {
  double slowest = 0.0;
  for (const Pipe& pipe : pipes_) {
    const double hz = refresh_hz_of(pipe.setting.mode);
    slowest = slowest == 0.0 ? hz : std::min(slowest, hz);
  }
  return slowest;
}

HeadShown CardHeads::shown(std::size_t head) const {
  for (const Pipe& pipe : pipes_) {
    if (pipe.target.head != head) continue;
    const std::optional<TimePoint> at = waiter_.flipped_at(card_.crtcs()[pipe.crtc].id());
    return {at ? HeadShown::Light::kNew : HeadShown::Light::kSame, at.value_or(TimePoint{}),
            refresh_hz_of(pipe.setting.mode), pipe.setting.is_deep ? 10 : 8};
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

void CardHeads::paint(const CanvasCopier& copier, Pipe* pipe) {
  copier.copy(*pipe->target.canvas, pipe->target.rotation,
              {pipe->back().gl_framebuffer(), pipe->setting.mode.hdisplay, pipe->setting.mode.vdisplay});
  pipe->is_painted = true;
}

void CardHeads::paint(const CanvasCopier& copier, std::size_t head) {
  for (Pipe& pipe : pipes_) {
    if (pipe.target.head == head) paint(copier, &pipe);
  }
}

bool CardHeads::is_painted() const {
  return std::any_of(pipes_.begin(), pipes_.end(), [](const Pipe& p) { return p.is_painted; });
}

Status CardHeads::flip() {
  AtomicRequest request;
  std::size_t count = 0;
  for (const Pipe& pipe : pipes_) {
    if (!pipe.is_painted) continue;
    request.set(card_.planes()[pipe.plane].properties, "FB_ID", pipe.back().kms_framebuffer());
    ++count;
  }
  void* const cookie = waiter_.expect(count);
  if (auto committed = request.commit_flip(card_, cookie); !committed) {
    waiter_.cancel();
    return committed;
  }
  for (Pipe& pipe : pipes_) {
    if (pipe.is_painted) pipe.front = 1 - pipe.front;
    pipe.is_painted = false;
  }
  return Done{};
}

Result<Flipped> CardHeads::wait(std::chrono::milliseconds timeout) { return waiter_.wait(card_, timeout); }

}  // namespace cyclorama::output
