// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/measured_head.h"

#include <fmt/format.h>

#include <utility>

#include "appliance/interchange/display_warp.h"
#include "appliance/interchange/warp_file.h"

namespace cyclorama::display {
namespace {

Result<HeadPlan> head_of(const interchange::WarpRegion& region, interchange::WarpProfile profile, const Pinhole& lens,
                         const interchange::WarpSetting& setting) {
  if (region.width_px != lens.width_px || region.height_px != lens.height_px) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("region '{}': it has {}x{} pixels, and the projector {}x{}; correct width_px and "
                             "height_px, or export it for these pixels",
                             region.id, region.width_px, region.height_px, lens.width_px, lens.height_px));
  }
  TRY_ASSIGN(const interchange::DirectionMap directions, interchange::directions_of(region, profile, setting));
  TRY_ASSIGN(warp::Warp warp, interchange::warp_from(directions, lens.width_px, lens.height_px, setting.picture));
  HeadPlan head{std::move(warp), interchange::mask_of(region)};
  head.picture = setting.picture;
  if (auto black = interchange::black_level_of(region)) {
    head.colour.black = Eigen::Vector3d::Ones();
    head.colour.black_lift = *std::move(black);
  }
  return head;
}

Result<HeadPlan> head_in(const InstalledProjector& projector, const interchange::WarpSetting& setting) {
  const InstalledWarp& installed = *projector.warp;
  interchange::WarpFileOptions options;
  options.width_px = projector.lens.width_px;
  options.height_px = projector.lens.height_px;
  if (!installed.mask.empty()) options.mask = installed.mask;
  TRY_ASSIGN(const interchange::WarpFile file, interchange::read_warp_file(installed.file, options));
  const bool has_namesake = installed.region.empty() && file.set.region(projector.name) != nullptr;
  const auto head = [&]() -> Result<HeadPlan> {
    TRY_ASSIGN(const interchange::WarpRegion* const region,
               interchange::chosen_region(file.set, has_namesake ? projector.name : installed.region));
    return head_of(*region, file.set.profile, projector.lens, setting);
  };
  auto made = head();
  if (!made) return std::move(made).error().while_doing(fmt::format("using warp '{}'", installed.file.string()));
  return made;
}

}  // namespace

Result<HeadPlan> measured_head(const Installation& installation, std::size_t projector, const PictureShape& picture) {
  const InstalledProjector& installed = installation.projectors.at(projector);
  CHECK(installed.warp.has_value());
  auto head = head_in(installed, {picture, installation.sweet_spot.xyz});
  if (!head) return std::move(head).error().while_doing(fmt::format("projector '{}'", installed.name));
  return head;
}

}  // namespace cyclorama::display
