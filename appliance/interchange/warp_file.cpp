// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_file.h"

#include <fmt/format.h>

#include <utility>

#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/warp_pfm.h"
#include "common/base/file.h"

namespace cyclorama::interchange {
namespace {

Error invalid(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

double aspect_of(const WarpFileOptions& options) {
  return static_cast<double>(options.width_px) / static_cast<double>(options.height_px);
}

WarpSet set_of(WarpRegion region, WarpProfile profile) {
  WarpSet set;
  set.profile = profile;
  set.buffers.push_back({"picture", 0, 0, {}});
  set.buffers.back().regions.push_back(std::move(region));
  return set;
}

Result<WarpNet> read_mesh(const std::filesystem::path& path, const std::string& ending,
                          const WarpFileOptions& options) {
  if (ending == ".data") return read_bourke(path, aspect_of(options));
  if (ending == ".obj") return read_warp_obj(path);
  if (ending == ".csv") return read_domeprojection(path);
  if (ending == ".simcad") return read_simcad(path);
  return invalid(
      fmt::format("'{}' ends like no warp file; use .mpcdi, .xml, .pfm, .data, .obj, .csv or .simcad", path.string()));
}

/// Returns the mesh to write: the mesh that was read, if it can be used, otherwise a grid over the region's map.
Result<WarpNet> mesh_of(const WarpFile& file, const WarpRegion& region, bool as_grid, const WarpFileOptions& options) {
  const bool serves = file.mesh && !options.grid && (!as_grid || file.mesh->triangles.empty());
  if (serves) return *file.mesh;
  const WarpGridSize grid = options.grid.value_or(kDefaultGrid);
  return net_from(region, grid.columns, grid.rows);
}

}  // namespace

Result<WarpFile> read_warp_file(const std::filesystem::path& path, const WarpFileOptions& options) {
  const std::string ending = path.extension().string();
  if (ending == ".mpcdi" || ending == ".xml") {
    TRY_ASSIGN(MpcdiFile file, read_mpcdi(path));
    return WarpFile{std::move(file.set), std::move(file.ignored), {}};
  }
  if (ending == ".pfm") {
    TRY_ASSIGN(WarpRegion region, read_warp_pair(path, options.mask, options.profile));
    return WarpFile{set_of(std::move(region), options.profile), {}, {}};
  }
  TRY_ASSIGN(WarpNet net, read_mesh(path, ending, options));
  auto region = region_from(net, path.stem().string(), options.width_px, options.height_px);
  if (!region) return std::move(region).error().while_doing(fmt::format("drawing mesh '{}'", path.string()));
  return WarpFile{set_of(*std::move(region), WarpProfile::k2d), {}, std::move(net)};
}

Result<const WarpRegion*> chosen_region(const WarpSet& set, const std::string& id) {
  std::string ids;
  const WarpRegion* only = nullptr;
  int count = 0;
  for (const WarpBuffer& buffer : set.buffers) {
    for (const WarpRegion& region : buffer.regions) {
      if (region.id == id) return &region;
      ids += fmt::format("{}'{}'", ids.empty() ? "" : ", ", region.id);
      only = &region;
      ++count;
    }
  }
  if (id.empty() && count == 1) return only;
  return invalid(fmt::format("which region is meant? There {} {}; name one", count == 1 ? "is" : "are", ids));
}

Status write_warp_file(const std::filesystem::path& path, const WarpFile& file, const std::string& id,
                       const WarpFileOptions& options) {
  const WarpSet& set = file.set;
  const std::string ending = path.extension().string();
  if (ending == ".mpcdi") {
    WarpSet stamped = set;
    stamped.version = options.version;
    return write_mpcdi(path, stamped);
  }
  if (ending != ".pfm" && ending != ".data" && ending != ".obj") {
    return invalid(fmt::format("'{}' cannot be written; use .mpcdi, .pfm, .data or .obj", path.string()));
  }
  TRY_ASSIGN(const WarpRegion* const region, chosen_region(set, id));
  const std::filesystem::path mask = options.mask.value_or(std::filesystem::path(path).replace_extension(".png"));
  if (ending == ".pfm") return write_warp_pair(path, mask, *region);
  if (set.profile != WarpProfile::k2d) {
    return invalid("a mesh says where in a flat picture to look, and this map does not; write .mpcdi or .pfm");
  }
  TRY_ASSIGN(const WarpNet net, mesh_of(file, *region, ending == ".data", options));
  if (ending == ".data") {
    return write_bourke(path, net, static_cast<double>(region->width_px) / static_cast<double>(region->height_px));
  }
  TRY(write_warp_obj(path, net));
  if (!region->alpha) return Done{};
  TRY_ASSIGN(const std::vector<std::byte> png, encode_mask_png(*region->alpha));
  return write_file_atomically(mask, png);
}

}  // namespace cyclorama::interchange
