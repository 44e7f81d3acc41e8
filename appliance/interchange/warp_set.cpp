// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_set.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include "appliance/interchange/fault.h"
#include "common/base/text.h"

namespace cyclorama::interchange {
namespace {

constexpr int kMaxSidePx = 65536;
constexpr std::size_t kMaxIdLength = 256;
constexpr double kAxisTolerance = 1e-3;  ///< Files may have only five decimals.

std::string place_of(const WarpRegion& region) { return fmt::format("region '{}'", printable(region.id)); }

bool all_finite(const double (&values)[3]) {
  return std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); });
}

Status check_id(const std::string& location, const std::string& id) {
  if (id.empty() || id.size() > kMaxIdLength) {
    return fault(location, fmt::format("an id has {} bytes", id.size()),
                 fmt::format("give it 1 to {} of them", kMaxIdLength));
  }
  if (printable(id, kMaxIdLength) != id) return fault(location, "its id is not plain UTF-8 text", "rename it");
  return Done{};
}

Status check_map(const std::string& location, std::string_view what, const WarpMap& map, bool flat) {
  if (map.empty()) return fault(location, fmt::format("its {} is empty", what), "export it again");
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const float* const sample = map.at(x, y);
      for (int i = 0; i < (flat ? 2 : 3); ++i) {
        if (std::isinf(sample[i])) {
          return fault(location, fmt::format("its {} is infinite at column {}, row {}", what, x, y),
                       "write NaN where nothing is mapped");
        }
      }
    }
  }
  return Done{};
}

Status check_mask(const std::string& location, std::string_view what, const MaskMap& mask) {
  const bool has_layout = mask.width_px > 0 && mask.height_px > 0 && (mask.channels == 1 || mask.channels == 3) &&
                          (mask.bits == 8 || mask.bits == 16);
  const std::size_t want = has_layout
                               ? static_cast<std::size_t>(mask.width_px) * static_cast<std::size_t>(mask.height_px) *
                                     static_cast<std::size_t>(mask.channels)
                               : 0;
  if (!has_layout || mask.samples.size() != want) {
    return fault(location, fmt::format("its {} has no picture of 1 or 3 channels in 8 or 16 bits", what),
                 "export it again");
  }
  if (mask.bits == 8 && std::any_of(mask.samples.begin(), mask.samples.end(), [](auto s) { return s > 255; })) {
    return fault(location, fmt::format("its {} has samples above 255 in 8 bits", what), "use 16 bits");
  }
  if (!(mask.gamma >= 0.1 && mask.gamma <= 10.0)) {
    return fault(location, fmt::format("the gamma of its {} is {}", what, mask.gamma), "give one of 0.1 to 10");
  }
  return Done{};
}

Status check_frustum(const std::string& location, const WarpFrustum& f) {
  for (const double angle : {f.yaw_deg, f.pitch_deg, f.roll_deg}) {
    if (!(std::abs(angle) <= 720.0)) return fault(location, "its frustum is turned by no angle", "give degrees");
  }
  for (const double angle : {f.right_deg, f.left_deg, f.up_deg, f.down_deg}) {
    if (!(std::abs(angle) < 90.0)) {
      return fault(location, fmt::format("an edge of its frustum lies at {} degrees", angle), "give less than 90");
    }
  }
  if (!(f.left_deg < f.right_deg) || !(f.down_deg < f.up_deg)) {
    return fault(location, "its frustum is empty or mirrored", "let left be below right, and down below up");
  }
  return Done{};
}

Status check_frame(const std::string& location, const WarpCoordinateFrame& frame) {
  const auto dot = [](const double(&a)[3], const double(&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const bool is_finite =
      all_finite(frame.position) && all_finite(frame.yaw) && all_finite(frame.pitch) && all_finite(frame.roll);
  const bool is_square = std::abs(dot(frame.yaw, frame.yaw) - 1.0) < kAxisTolerance &&
                         std::abs(dot(frame.pitch, frame.pitch) - 1.0) < kAxisTolerance &&
                         std::abs(dot(frame.roll, frame.roll) - 1.0) < kAxisTolerance &&
                         std::abs(dot(frame.yaw, frame.pitch)) < kAxisTolerance &&
                         std::abs(dot(frame.yaw, frame.roll)) < kAxisTolerance &&
                         std::abs(dot(frame.pitch, frame.roll)) < kAxisTolerance;
  if (!is_finite || !is_square) {
    return fault(location, "the axes of its coordinateFrame are not of length 1 and at right angles", "correct them");
  }
  return Done{};
}

Status check_parts(const std::string& location, const WarpRegion& region, WarpProfile profile) {
  const bool in_space = profile == WarpProfile::kAdvanced3d || profile == WarpProfile::kShaderLamps;
  if ((profile == WarpProfile::k2d || profile == WarpProfile::kAdvanced3d) && !region.map) {
    return fault(location, "it has no geometryWarpFile", "export it with its warp");
  }
  if ((profile == WarpProfile::k3d || profile == WarpProfile::kShaderLamps) && !region.frustum) {
    return fault(location, "its profile needs a frustum and it has none", "export it as 2d or a3, or with its frustum");
  }
  if (profile == WarpProfile::kShaderLamps && !region.coordinate_frame) {
    return fault(location, "shader lamps need a coordinateFrame and it has none",
                 "export it with the projector's place");
  }
  if (profile == WarpProfile::kShaderLamps && region.origin == DataOrigin::kIdealEyePoint) {
    return fault(location, "shader lamps have no ideal eye point", "measure from floorCenter or centerOfMass");
  }
  if (region.map) TRY(check_map(location, "geometryWarpFile", *region.map, !in_space));
  if (region.distortion) TRY(check_map(location, "distortionMap", *region.distortion, true));
  return Done{};
}

}  // namespace

std::optional<double> metres_in(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMillimetre:
      return 0.001;
    case LengthUnit::kCentimetre:
      return 0.01;
    case LengthUnit::kDecimetre:
      return 0.1;
    case LengthUnit::kMetre:
      return 1.0;
    case LengthUnit::kInch:
      return 0.0254;
    case LengthUnit::kFoot:
      return 0.3048;
    case LengthUnit::kYard:
      return 0.9144;
    case LengthUnit::kUnknown:
      break;
  }
  return std::nullopt;
}

bool same_bits(const WarpMap& a, const WarpMap& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         (a.empty() || std::memcmp(a.data().data(), b.data().data(), a.data().size_bytes()) == 0);
}

MaskMap::MaskMap(int width, int height, int channel_count, int bit_count)
    : width_px(width),
      height_px(height),
      channels(channel_count),
      bits(bit_count),
      samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
              static_cast<std::size_t>(channel_count)) {}

double MaskMap::light_at(int x, int y) const {
  const std::size_t at =
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)) *
      static_cast<std::size_t>(channels);
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels); ++i) {
    sum += std::pow(static_cast<double>(samples[at + i]) / largest(), gamma);
  }
  return sum / channels;
}

bool operator==(const WarpRegion& a, const WarpRegion& b) {
  const auto same_map = [](const std::optional<WarpMap>& one, const std::optional<WarpMap>& other) {
    return one.has_value() == other.has_value() && (!one || same_bits(*one, *other));
  };
  return a.id == b.id && a.width_px == b.width_px && a.height_px == b.height_px && a.rect == b.rect &&
         a.frustum == b.frustum && a.coordinate_frame == b.coordinate_frame && same_map(a.map, b.map) &&
         a.unit == b.unit && a.origin == b.origin && a.interpolation == b.interpolation && a.alpha == b.alpha &&
         a.beta == b.beta && same_map(a.distortion, b.distortion);
}

const WarpRegion* WarpSet::region(const std::string& id) const {
  for (const WarpBuffer& buffer : buffers) {
    for (const WarpRegion& candidate : buffer.regions) {
      if (candidate.id == id) return &candidate;
    }
  }
  return nullptr;
}

Status check(const WarpRegion& region, WarpProfile profile) {
  const std::string location = place_of(region);
  TRY(check_id(location, region.id));
  if (region.width_px < 1 || region.height_px < 1 || region.width_px > kMaxSidePx || region.height_px > kMaxSidePx) {
    return fault(location, fmt::format("it has {}x{} pixels", region.width_px, region.height_px),
                 fmt::format("give the projector's, 1 to {} each way", kMaxSidePx));
  }
  const RegionRect& r = region.rect;
  constexpr double kSlack = 1e-6;  // For rounded thirds and sevenths.
  const auto fits = [&](double at, double size) {
    return at >= -kSlack && at <= 1.0 + kSlack && size > 0.0 && at + size <= 1.0 + kSlack;
  };
  if (!fits(r.x, r.width) || !fits(r.y, r.height)) {
    return fault(location, fmt::format("its rectangle {} {} {} {} leaves the buffer", r.x, r.y, r.width, r.height),
                 "keep x, y, xSize and ySize within 0 to 1");
  }
  if (region.frustum) TRY(check_frustum(location, *region.frustum));
  if (region.coordinate_frame) TRY(check_frame(location, *region.coordinate_frame));
  if (region.alpha) TRY(check_mask(location, "alphaMap", *region.alpha));
  if (region.beta) TRY(check_mask(location, "betaMap", *region.beta));
  return check_parts(location, region, profile);
}

Status check(const WarpSet& set) {
  std::set<std::string> buffers;
  std::set<std::string> regions;
  for (const WarpBuffer& buffer : set.buffers) {
    const std::string location = fmt::format("buffer '{}'", printable(buffer.id));
    TRY(check_id(location, buffer.id));
    if (!buffers.insert(buffer.id).second) return fault(location, "its id is there twice", "rename one");
    if (buffer.width_px < 0 || buffer.height_px < 0) return fault(location, "its size is negative", "correct it");
    if (buffer.regions.empty()) return fault(location, "it has no region", "export it with its projectors");
    for (const WarpRegion& region : buffer.regions) {
      TRY(check(region, set.profile));
      if (!regions.insert(region.id).second) return fault(place_of(region), "its id is there twice", "rename one");
    }
  }
  if (set.buffers.empty()) return fault("display", "it has no buffer", "export it with its projectors");
  if (set.level < 1 || set.level > 4 || set.colour_level < 1 || set.colour_level > 4) {
    return fault("MPCDI", fmt::format("level {} of geometry, {} of colour", set.level, set.colour_level),
                 "give 1 to 4");
  }
  if (printable(set.date, kMaxIdLength) != set.date) return fault("MPCDI", "its date is no text", "correct it");
  return Done{};
}

}  // namespace cyclorama::interchange
