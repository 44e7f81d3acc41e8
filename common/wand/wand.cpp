// SPDX-License-Identifier: Apache-2.0
#include "common/wand/wand.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/check.h"
#include "common/config/config.h"

namespace cyclorama {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxTags = 32;
/// Upper bound of tag ids: the largest of libapriltag's families has 48714 tags.
constexpr double kLastId = 65535;
/// Tolerance for measuring with a ruler and folding; corners in a wrong order deviate by 40 %.
constexpr double kMaxRelativeDeviation = 0.03;

bool is_square(const WandTag& tag) {
  const auto is_near = [&](double length, double wanted) {
    return std::abs(length - wanted) <= kMaxRelativeDeviation * tag.size_m;
  };
  for (std::size_t i = 0; i < 4; ++i) {
    if (!is_near((tag.corners[(i + 1) % 4] - tag.corners[i]).norm(), tag.size_m)) return false;
  }
  const double diagonal = std::sqrt(2.0) * tag.size_m;
  return is_near((tag.corners[2] - tag.corners[0]).norm(), diagonal) &&
         is_near((tag.corners[3] - tag.corners[1]).norm(), diagonal);
}

WandTag read_tag(ConfigTable table, std::set<int>* ids) {
  WandTag tag;
  tag.id = table.integer("id", {0, kLastId});
  tag.size_m = 1e-3 * table.number("size_mm", {1, 10000});
  const auto corners = table.points("corners_mm", 3, {-10000, 10000});
  if (!ids->insert(tag.id).second) table.refuse("id", "is there twice; a wand shows each tag once");
  if (corners.size() != 4) {
    table.refuse("corners_mm", "must be four points [x, y, z]: left above, right above, right below, left below");
    return tag;
  }
  for (std::size_t i = 0; i < 4; ++i) tag.corners[i] = 1e-3 * Vector3d(corners[i][0], corners[i][1], corners[i][2]);
  if (!is_square(tag)) {
    table.refuse("corners_mm",
                 "are not the corners of a square of size_mm, in the order left above, right above, right below, left "
                 "below; measure again");
  }
  return tag;
}

Result<Wand> from_config(Config* config) {
  Wand wand;
  ConfigTable root = config->root();
  wand.name = root.text("name", "wand");
  std::set<int> ids;
  for (ConfigTable& table : root.tables("tag")) {
    if (wand.tags.size() == kMaxTags) {
      table.refuse("id", fmt::format("is one too many: a wand has at most {} tags", kMaxTags));
      break;
    }
    wand.tags.push_back(read_tag(table, &ids));
  }
  if (wand.tags.empty()) root.refuse("tag", "is missing: a wand needs [[tag]] tables, at least one");
  TRY(config->finish());
  return wand;
}

}  // namespace

Wand flat_tag(int id, double size_m) {
  CHECK(size_m > 0.0);
  const double half = 0.5 * size_m;
  return {fmt::format("tag {}", id),
          {{id,
            size_m,
            {Vector3d(-half, -half, 0), Vector3d(half, -half, 0), Vector3d(half, half, 0), Vector3d(-half, half, 0)}}}};
}

RigidTransform<frame::Tag, frame::Face> face_of(const WandTag& tag) {
  const auto& [a, b, c, d] = tag.corners;
  const Vector3d x = (b + c - a - d).normalized();
  const Vector3d z = x.cross(c + d - a - b).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return {Eigen::Quaterniond(axes), 0.25 * (a + b + c + d)};
}

Result<Wand> read_wand(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return from_config(&config);
}

Result<Wand> parse_wand(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return from_config(&config);
}

std::string wand_toml(const Wand& wand) {
  std::string quoted;
  for (const char c : wand.name) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) >= ' ' && c != '\x7f') quoted += c;
  }
  std::string text = fmt::format("name = \"{}\"\n", quoted);
  for (const WandTag& tag : wand.tags) {
    text += fmt::format("\n[[tag]]\nid = {}\nsize_mm = {:.3f}\ncorners_mm = [\n", tag.id, 1e3 * tag.size_m);
    for (const Vector3d& corner : tag.corners) {
      text += fmt::format("  [{:.3f}, {:.3f}, {:.3f}],\n", 1e3 * corner.x(), 1e3 * corner.y(), 1e3 * corner.z());
    }
    text += "]\n";
  }
  return text;
}

}  // namespace cyclorama
