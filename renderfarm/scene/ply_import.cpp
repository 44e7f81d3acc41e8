// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "common/base/file.h"
#include "common/base/text.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/ply_cursor.h"
#include "renderfarm/scene/ply_header.h"
#include "renderfarm/scene/ply_mesh.h"

namespace cyclorama::scene {
namespace {

template <typename Cursor>
Error bad_row(const Cursor& cursor, const PlyElement& element, std::uint64_t row) {
  return Error(ErrorCode::kBadData, fmt::format("row {} of '{}': {}", row, printable(element.name), cursor.what()));
}

/// Reads one list into `ret_values`, reused from row to row, or skips it if that is null. Returns false if the file
/// ends inside the list.
template <typename Cursor>
bool read_list(Cursor* cursor, const PlyProperty& property, std::vector<double>* ret_values) {
  if (ret_values != nullptr) ret_values->clear();
  double count = 0.0;
  if (!cursor->read(*property.count_type, &count)) return false;
  for (double done = 0.0; done < count; done += 1.0) {
    double value = 0.0;
    if (!cursor->read(property.type, &value)) return false;
    if (ret_values != nullptr) ret_values->push_back(value);
  }
  return true;
}

template <typename Cursor>
Status read_vertices(Cursor* cursor, const PlyElement& element, PlyMesh* mesh) {
  const PlyVertexLayout layout(element);
  std::array<double, kNoRole + 1> row{};
  for (std::uint64_t i = 0; i < element.count; ++i) {
    bool good = cursor->begin_row();
    for (std::size_t k = 0; good && k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      good = property.count_type ? read_list(cursor, property, nullptr)
                                 : cursor->read(property.type, &row[layout.role(k)]);
    }
    if (!good || !cursor->end_row()) return bad_row(*cursor, element, i);
    mesh->add_vertex(layout, row);
  }
  return Done{};
}

/// Reads faces, strips and unused elements; calls `use` with the list named in `wanted` of each row, if any.
template <typename Cursor, typename Use>
Status read_lists(Cursor* cursor, const PlyElement& element, std::size_t wanted, const Use& use) {
  std::vector<double> list;
  double unused = 0.0;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    bool good = cursor->begin_row();
    for (std::size_t k = 0; good && k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      good = property.count_type ? read_list(cursor, property, k == wanted ? &list : nullptr)
                                 : cursor->read(property.type, &unused);
    }
    if (!good || !cursor->end_row()) return bad_row(*cursor, element, i);
    if (wanted == element.properties.size()) continue;
    if (Status used = use(list); !used) {
      return std::move(used).error().while_doing(fmt::format("row {} of '{}'", i, printable(element.name)));
    }
  }
  return Done{};
}

std::size_t index_list_of(const PlyElement& element) {
  const auto is_index_list = [](const PlyProperty& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  };
  return static_cast<std::size_t>(std::find_if(element.properties.begin(), element.properties.end(), is_index_list) -
                                  element.properties.begin());
}

template <typename Cursor>
Status read_body(Cursor cursor, const PlyHeader& header, PlyMesh* mesh) {
  TRY(mesh->begin(header));
  for (const PlyElement& element : header.elements) {
    const std::size_t indices = index_list_of(element);
    if (element.name == "vertex") {
      TRY(read_vertices(&cursor, element, mesh));
    } else if (element.name == "face") {
      TRY(mesh->reserve_triangles(element.count));
      TRY(read_lists(&cursor, element, indices,
                     [&](const std::vector<double>& list) { return mesh->add_polygon(list); }));
    } else if (element.name == "tristrips") {
      TRY(read_lists(&cursor, element, indices,
                     [&](const std::vector<double>& list) { return mesh->add_strip(list); }));
    } else {
      TRY(read_lists(&cursor, element, element.properties.size(), [](const std::vector<double>&) { return Done{}; }));
    }
  }
  return Done{};
}

Result<Model> import_bytes(std::span<const std::byte> file, const ImportLimits& limits) {
  TRY_ASSIGN(const PlyHeader header, parse_ply_header(file));
  PlyMesh mesh(limits.memory_bytes);
  switch (header.encoding) {
    case PlyEncoding::kAscii:
      TRY(read_body(PlyTextCursor(file, header), header, &mesh));
      break;
    case PlyEncoding::kLittleEndian:
      TRY(read_body(PlyBinaryCursor<std::endian::native != std::endian::little>(file, header), header, &mesh));
      break;
    case PlyEncoding::kBigEndian:
      TRY(read_body(PlyBinaryCursor<std::endian::native != std::endian::big>(file, header), header, &mesh));
      break;
  }
  Result<Model> model = std::move(mesh).finish();
  if (model && header.stray_lines > 0) {
    model->notes.push_back(fmt::format("{} lines of the PLY header are no part of PLY: skipped", header.stray_lines));
  }
  if (model && !header.texture_file.empty()) {
    model->notes.push_back(
        fmt::format("the texture '{}' is not shown: PLY textures are not supported; convert it to glTF",
                    printable(header.texture_file)));
  }
  return model;
}

}  // namespace

Result<Model> import_ply(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  Result<Model> model = import_bytes(file.bytes(), limits);
  if (!model) return std::move(model).error().while_doing(fmt::format("'{}'", path.string()));
  return model;
}

}  // namespace cyclorama::scene
