// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/base/file.h"
#include "renderfarm/scene/e57_pages.h"
#include "renderfarm/scene/e57_scan.h"
#include "renderfarm/scene/e57_xml.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/point_cloud.h"

namespace cyclorama::scene {
namespace {

constexpr std::uint64_t kMaxXmlBytes = std::uint64_t{64} << 20;

Result<Model> import_e57_bytes(std::span<const std::byte> file, const ImportLimits& limits) {
  TRY_ASSIGN(const E57Pages pages, E57Pages::open(file));
  if (pages.xml_bytes() > kMaxXmlBytes) {
    return Error(ErrorCode::kBadData,
                 fmt::format("its XML has {} bytes; at most {} are read", pages.xml_bytes(), kMaxXmlBytes));
  }
  TRY_ASSIGN(const std::vector<std::byte> xml, pages.read(pages.xml_offset(), pages.xml_bytes()));
  TRY_ASSIGN(const E57Node root, parse_e57_xml({reinterpret_cast<const char*>(xml.data()), xml.size()}));
  const E57Node* const scans = root.child("data3D");
  if (scans == nullptr || scans->children.empty()) return Error(ErrorCode::kBadData, "it holds no scans");
  PointCloud cloud(limits.memory_bytes);
  std::size_t grey = 0;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < scans->children.size(); ++i) {
    const std::string place = fmt::format("scan {} of {}", i + 1, scans->children.size());
    Result<E57Scan> scan = E57Scan::open(pages, scans->children[i]);
    if (!scan) return std::move(scan).error().while_doing(place);
    TRY(cloud.check_memory(scan->point_count()));
    if (!scan->has_colour() && scan->has_intensity()) ++grey;
    points += scan->point_count();
    if (Status read = std::move(*scan).read(&cloud); !read) return std::move(read).error().while_doing(place);
  }
  std::vector<std::string> notes;
  if (grey > 0) notes.push_back(fmt::format("{} scans have no colours: shown by their intensity", grey));
  if (cloud.added() < points) notes.push_back(fmt::format("{} points are invalid: left out", points - cloud.added()));
  return std::move(cloud).finish(std::move(notes));
}

}  // namespace

Result<Model> import_e57(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  Result<Model> model = import_e57_bytes(file.bytes(), limits);
  if (!model) return std::move(model).error().while_doing(fmt::format("'{}'", path.string()));
  return model;
}

}  // namespace cyclorama::scene
