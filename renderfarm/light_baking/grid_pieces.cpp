// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/grid_pieces.h"

#include <bit>

#include "renderfarm/light/light_store.h"

namespace cyclorama::light_baking {
namespace {

using light::TriangleGrid;

constexpr std::size_t kProbeLightBytes = 4 * sizeof(float);

void add(const std::vector<ProbeLight>& light, PieceWriter* to) {
  to->add(static_cast<std::uint32_t>(light.size()));
  for (const auto& [value, error] : light) {
    to->add(value);
    to->add(error);
  }
}

void add(const std::vector<std::uint8_t>& flags, PieceWriter* to) {
  to->add(static_cast<std::uint32_t>(flags.size()));
  for (const std::uint8_t flag : flags) to->add(flag);
}

std::vector<ProbeLight> read_light(PieceReader* from) {
  std::vector<ProbeLight> light(from->read_count(kProbeLightBytes));
  for (auto& [value, error] : light) {
    value = from->read_vector();
    error = from->read<float>();
  }
  return light;
}

std::vector<std::uint8_t> read_flags(PieceReader* from) {
  std::vector<std::uint8_t> flags(from->read_count(1));
  for (std::uint8_t& flag : flags) flag = from->read<std::uint8_t>() != 0 ? 1 : 0;
  return flags;
}

bool are_parts(int parts) {
  return parts >= 1 && parts <= TriangleGrid::kMaxParts && std::has_single_bit(static_cast<unsigned>(parts));
}

Error bad_grid() { return Error(ErrorCode::kBadData, "a piece of light has a grid that no triangle can have"); }

}  // namespace

// The structured bindings below do not compile if a member is added, so that none is forgotten.

void add(const GridInWork& grid, PieceWriter* to) {
  const auto& [triangle, max_parts, visible_parts, is_smooth, parts, squared_error, is_needed, has_blocked_corner,
               needs_surfaces, is_misread, light, rough] = grid;
  to->add(triangle);
  to->add(max_parts);
  to->add(visible_parts);
  to->add(parts);
  to->add(squared_error);
  for (const bool flag : {is_smooth, is_needed, has_blocked_corner, needs_surfaces, is_misread})
    to->add(static_cast<std::uint8_t>(flag ? 1 : 0));
  add(light, to);
  add(rough, to);
}

Result<GridInWork> read_grid_in_work(PieceReader* from, std::size_t triangles) {
  GridInWork grid;
  auto& [triangle, max_parts, visible_parts, is_smooth, parts, squared_error, is_needed, has_blocked_corner,
         needs_surfaces, is_misread, light, rough] = grid;
  triangle = from->read<std::uint32_t>();
  max_parts = from->read<int>();
  visible_parts = from->read<double>();
  parts = from->read<int>();
  squared_error = from->read<float>();
  for (bool* const flag : {&is_smooth, &is_needed, &has_blocked_corner, &needs_surfaces, &is_misread})
    *flag = from->read<std::uint8_t>() != 0;
  light = read_light(from);
  rough = read_flags(from);
  const auto samples = parts == 0 ? std::size_t{0} : static_cast<std::size_t>(TriangleGrid::samples(parts));
  const bool is_sound = triangle < triangles && are_parts(max_parts) && (parts == 0 || are_parts(parts)) &&
                        parts <= max_parts && light.size() == samples && rough.size() == samples;
  if (!is_sound) return bad_grid();
  return grid;
}

void add(const MadeGrid& grid, PieceWriter* to) {
  const auto& [triangle, parts, light, separate] = grid;
  to->add(triangle);
  to->add(parts);
  add(light, to);
  add(separate, to);
}

Result<MadeGrid> read_made_grid(PieceReader* from, std::size_t triangles) {
  MadeGrid grid;
  auto& [triangle, parts, light, separate] = grid;
  triangle = from->read<std::uint32_t>();
  parts = from->read<int>();
  light = read_light(from);
  separate = read_flags(from);
  if (triangle >= triangles || !are_parts(parts)) return bad_grid();
  const auto samples = static_cast<std::size_t>(TriangleGrid::samples(parts));
  if (light.size() != samples || separate.size() != samples) return bad_grid();
  return grid;
}

}  // namespace cyclorama::light_baking
