// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_pfm.h"

#include <cmath>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/mask_png.h"
#include "common/base/file.h"
#include "common/image/pfm.h"

namespace cyclorama::interchange {
namespace {

/// Converts a mask to linear grey of 16 bits, which readers of these pairs assume.
MaskMap as_linear_grey16(const MaskMap& mask) {
  if (mask.channels == 1 && mask.bits == 16 && mask.gamma == 1.0) return mask;
  MaskMap grey(mask.width_px, mask.height_px, 1, 16);
  std::size_t i = 0;
  for (int y = 0; y < mask.height_px; ++y) {
    for (int x = 0; x < mask.width_px; ++x) {
      grey.samples[i++] = static_cast<std::uint16_t>(std::lround(65535.0 * mask.light_at(x, y)));
    }
  }
  return grey;
}

Result<WarpRegion> read_pair(const std::filesystem::path& pfm, const std::optional<std::filesystem::path>& mask,
                             WarpProfile profile, const WarpLimits& limits) {
  WarpRegion region;
  region.id = pfm.stem().string();
  {
    TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(pfm, limits.file_bytes));
    TRY_ASSIGN(region.map, decode_warp_pfm(bytes, limits));
  }
  region.width_px = region.map->width();
  region.height_px = region.map->height();
  if (mask) {
    const std::string doing = fmt::format("its mask '{}'", mask->string());
    auto bytes = read_file(*mask, limits.file_bytes);
    if (!bytes) return std::move(bytes).error().while_doing(doing);
    auto alpha = decode_mask_png(*bytes, limits.map_px);
    if (!alpha) return std::move(alpha).error().while_doing(doing);
    region.alpha = *std::move(alpha);
  }
  TRY(check(region, profile));
  return region;
}

}  // namespace

Result<WarpMap> decode_warp_pfm(std::span<const std::byte> pfm, const WarpLimits& limits) {
  if (pfm.size() >= 2 && pfm[0] == std::byte{'P'} && pfm[1] == std::byte{'f'}) {
    return fault("byte 1", "this PFM is grey and a warp has three channels", "export it in colour ('PF')");
  }
  return decode_pfm(pfm, limits.map_px);
}

Result<WarpRegion> read_warp_pair(const std::filesystem::path& pfm, const std::optional<std::filesystem::path>& mask,
                                  WarpProfile profile, const WarpLimits& limits) {
  auto region = read_pair(pfm, mask, profile, limits);
  if (!region) return std::move(region).error().while_doing(fmt::format("reading warp '{}'", pfm.string()));
  return region;
}

Status write_warp_pair(const std::filesystem::path& pfm, const std::filesystem::path& mask, const WarpRegion& region) {
  if (!region.map || region.map->empty()) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("region '{}' has no map to write as PFM", region.id));
  }
  TRY(write_file_atomically(pfm, encode_pfm(*region.map)));
  if (!region.alpha) return Done{};
  TRY_ASSIGN(const std::vector<std::byte> png, encode_mask_png(as_linear_grey16(*region.alpha)));
  return write_file_atomically(mask, png);
}

}  // namespace cyclorama::interchange
