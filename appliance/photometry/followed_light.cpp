// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/followed_light.h"

#include "appliance/photometry/light_file.h"
#include "appliance/photometry/reblend.h"

namespace cyclorama::photometry {

Result<std::optional<FollowedLight>> follow_light(const std::filesystem::path& own_folder,
                                                  std::span<const calibration::CalibratedProjector> before,
                                                  std::span<const calibration::CalibratedProjector> after,
                                                  const std::function<double(const Eigen::Vector3d&)>& inverse_depth) {
  TRY_ASSIGN(const std::vector<calibration::CalibratedColour> colours, calibration::read_colours(own_folder));
  if (colours.empty()) return std::optional<FollowedLight>();
  FollowedLight followed;
  auto light = read_light(own_folder);
  if (!light) return std::move(light).error().while_doing("reading the previous light");
  followed.lighting = *std::move(light);
  bool is_same = before.size() == after.size() && followed.lighting.projectors.size() == after.size();
  std::vector<PhotometricProjector> projectors;
  for (std::size_t p = 0; is_same && p < after.size(); ++p) {
    is_same = before[p].name == after[p].name;
    projectors.push_back({after[p].name, after[p].map});
    move_light(before[p].map, after[p].map, inverse_depth, &followed.lighting.projectors[p]);
  }
  if (!is_same) return Error(ErrorCode::kInvalidArgument, "the previous light belongs to other projectors");
  TRY_ASSIGN(followed.photometry, reblended(projectors, followed.lighting, colours));
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    followed.colours.push_back(
        {projectors[p].name, followed.photometry.heads[p].mask, followed.photometry.heads[p].colour});
  }
  return std::optional<FollowedLight>(std::move(followed));
}

}  // namespace cyclorama::photometry
