// SPDX-License-Identifier: Apache-2.0
/// A readable scene.toml remains readable after an area was written into it, and has that area.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "renderfarm/scene/scene_package.h"
#include "renderfarm/walkable/walkable_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto before = cyclorama::scene::parse_scene_package(text, "scene.toml", ".");
  if (!before) return 0;
  cyclorama::walkable::WalkableGround ground;
  const Eigen::Vector3d eye = before->start_eye.value_or(Eigen::Vector3d(0, 1.6, 0));
  const Eigen::Vector2d at(eye.x(), eye.z());
  ground.outline = {at + Eigen::Vector2d(-9, -9), at + Eigen::Vector2d(9, -9), at + Eigen::Vector2d(0, 9)};
  ground.holes = {{at + Eigen::Vector2d(1, 1), at + Eigen::Vector2d(2, 1), at + Eigen::Vector2d(1, 2)}};
  const auto changed = cyclorama::walkable::with_walkable(text, "scene.toml", ground, eye);
  if (!changed) return 0;
  // The program refuses to save a file that cannot be read again; a file that can be read must have the area.
  const auto after = cyclorama::scene::parse_scene_package(*changed, "scene.toml", ".");
  if (after) CHECK(after->walkable.size() == 3 && after->walkable_holes.size() == 1 && after->title == before->title);
  return 0;
}
