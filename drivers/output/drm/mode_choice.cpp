// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/mode_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace cyclorama::output {
namespace {

constexpr std::size_t kMaxModes = 32;
constexpr std::uint32_t kUnfit = DRM_MODE_FLAG_DBLSCAN | DRM_MODE_FLAG_3D_MASK;

/// Returns 1024x768 at 60 Hz (VESA DMT id 0x10).
drmModeModeInfo safe_mode() {
  drmModeModeInfo mode{};
  mode.clock = 65000;
  mode.hdisplay = 1024;
  mode.hsync_start = 1048;
  mode.hsync_end = 1184;
  mode.htotal = 1344;
  mode.vdisplay = 768;
  mode.vsync_start = 771;
  mode.vsync_end = 777;
  mode.vtotal = 806;
  mode.vrefresh = 60;
  mode.flags = DRM_MODE_FLAG_NHSYNC | DRM_MODE_FLAG_NVSYNC;
  mode.type = DRM_MODE_TYPE_USERDEF;
  std::strncpy(mode.name, "1024x768", sizeof mode.name - 1);
  return mode;
}

bool is_fit(const drmModeModeInfo& mode) {
  return (mode.flags & kUnfit) == 0 && mode.hdisplay > 0 && mode.vdisplay > 0 && refresh_hz_of(mode) > 0.0;
}

/// Returns a sort key; modes with smaller keys are better.
auto rank(const drmModeModeInfo& mode, const ModePreference& preferred) {
  const bool has_preferred_size = mode.hdisplay == preferred.width_px && mode.vdisplay == preferred.height_px;
  const bool is_preferred = (mode.type & DRM_MODE_TYPE_PREFERRED) != 0;
  const bool is_interlaced = (mode.flags & DRM_MODE_FLAG_INTERLACE) != 0;
  const int group = is_interlaced ? 3 : has_preferred_size ? 0 : is_preferred ? 1 : 2;
  const int pixels = static_cast<int>(mode.hdisplay) * mode.vdisplay;
  // Rates that differ by less than this count as equal, such as 59.94 and 60 Hz.
  constexpr double kSameRate_hz = 0.25;
  const double off = std::round(std::abs(refresh_hz_of(mode) - preferred.refresh_hz) / kSameRate_hz);
  return std::make_tuple(group, group == 0 ? 0 : -pixels, off, is_preferred ? 0 : 1);
}

}  // namespace

double refresh_hz_of(const drmModeModeInfo& mode) {
  if (mode.htotal == 0 || mode.vtotal == 0) return 0.0;
  return 1000.0 * mode.clock / (static_cast<double>(mode.htotal) * mode.vtotal);
}

std::string text_of(const drmModeModeInfo& mode) {
  return fmt::format("{}x{}@{:.2f}", mode.hdisplay, mode.vdisplay, refresh_hz_of(mode));
}

bool is_same_mode(const drmModeModeInfo& a, const drmModeModeInfo& b) {
  const auto timing = [](const drmModeModeInfo& m) {
    return std::make_tuple(m.clock, m.hdisplay, m.hsync_start, m.hsync_end, m.htotal, m.hskew, m.vdisplay,
                           m.vsync_start, m.vsync_end, m.vtotal, m.vscan, m.flags);
  };
  return timing(a) == timing(b);
}

std::vector<drmModeModeInfo> modes_of(std::span<const VideoTiming> timings) {
  std::vector<drmModeModeInfo> modes;
  for (const VideoTiming& timing : timings) {
    drmModeModeInfo mode{};
    const auto u16 = [](int value) { return static_cast<std::uint16_t>(value); };
    const TimingAxis& h = timing.horizontal;
    const TimingAxis& v = timing.vertical;
    // The kernel counts the blanking of an interlaced mode for both fields, with one line between them.
    const int fields = timing.is_interlaced ? 2 : 1;
    mode.clock = static_cast<std::uint32_t>(timing.clock_khz);
    mode.hdisplay = u16(h.visible);
    mode.hsync_start = u16(h.visible + h.front_porch);
    mode.hsync_end = u16(h.visible + h.front_porch + h.sync);
    mode.htotal = u16(h.total());
    mode.vdisplay = u16(v.visible);
    mode.vsync_start = u16(v.visible + fields * v.front_porch);
    mode.vsync_end = u16(v.visible + fields * (v.front_porch + v.sync));
    mode.vtotal = u16(v.visible + fields * (v.front_porch + v.sync + v.back_porch) + (fields - 1));
    mode.vrefresh = static_cast<std::uint32_t>(std::lround(timing.refresh_hz()));
    mode.flags = (h.is_sync_positive ? DRM_MODE_FLAG_PHSYNC : DRM_MODE_FLAG_NHSYNC) |
                 (v.is_sync_positive ? DRM_MODE_FLAG_PVSYNC : DRM_MODE_FLAG_NVSYNC) |
                 (timing.is_interlaced ? DRM_MODE_FLAG_INTERLACE : 0U);
    mode.type = DRM_MODE_TYPE_DRIVER | (timing.is_preferred ? DRM_MODE_TYPE_PREFERRED : 0U);
    std::strncpy(mode.name, fmt::format("{}x{}", h.visible, v.visible).c_str(), sizeof mode.name - 1);
    modes.push_back(mode);
  }
  return modes;
}

std::vector<drmModeModeInfo> modes_to_try(std::span<const drmModeModeInfo> offered, const ModePreference& preferred) {
  std::vector<drmModeModeInfo> sorted;
  std::copy_if(offered.begin(), offered.end(), std::back_inserter(sorted), is_fit);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const auto& a, const auto& b) { return rank(a, preferred) < rank(b, preferred); });
  std::vector<drmModeModeInfo> modes;
  for (const drmModeModeInfo& mode : sorted) {
    const bool has_rates = mode.hdisplay == preferred.width_px && mode.vdisplay == preferred.height_px;
    // A card that refuses a size for its bandwidth accepts a smaller one sooner than another rate.
    const auto is_covered = [&](const drmModeModeInfo& m) {
      return is_same_mode(m, mode) || (!has_rates && m.hdisplay == mode.hdisplay && m.vdisplay == mode.vdisplay &&
                                       (m.flags & DRM_MODE_FLAG_INTERLACE) == (mode.flags & DRM_MODE_FLAG_INTERLACE));
    };
    if (modes.size() + 1 < kMaxModes && std::none_of(modes.begin(), modes.end(), is_covered)) modes.push_back(mode);
  }
  const auto is_safe = [](const drmModeModeInfo& m) { return is_same_mode(m, safe_mode()); };
  if (std::none_of(modes.begin(), modes.end(), is_safe)) modes.push_back(safe_mode());
  return modes;
}

}  // namespace cyclorama::output
