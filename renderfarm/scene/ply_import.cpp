// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "renderfarm/scene/file_beside.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/ply_cursor.h"
#include "renderfarm/scene/ply_header.h"
#include "renderfarm/scene/ply_mesh.h"
#include "renderfarm/scene/splat_ply.h"

namespace cyclorama::scene {
namespace {

template <typename Cursor>
Error bad_row(const Cursor& cursor, const PlyElement& element, std::uint64_t row) {
  return Error(ErrorCode::kBadData, fmt::format("row {} of '{}': {}", row, printable(element.name), cursor.what()));
}

/// Reads one list into `ret_values`, which is reused from row to row, or skips the list if `ret_values` is null.
/// Returns false if the file ends inside the list.
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

/// Indices of the properties of faces and strips that are used; an index is the number of properties if the element
/// lacks that property.
struct FaceColumns {
  explicit FaceColumns(const PlyElement& element)
      : corners(column_of(element, {"vertex_indices", "vertex_index"}, true)),
        texcoords(column_of(element, {"texcoord"}, true)),
        texture(column_of(element, {"texnumber"}, false)) {}

  static std::size_t column_of(const PlyElement& element, std::initializer_list<std::string_view> names, bool is_list) {
    const auto is_it = [&](const PlyProperty& p) {
      return p.count_type.has_value() == is_list && std::find(names.begin(), names.end(), p.name) != names.end();
    };
    return static_cast<std::size_t>(std::find_if(element.properties.begin(), element.properties.end(), is_it) -
                                    element.properties.begin());
  }

  std::size_t corners;
  std::size_t texcoords;
  std::size_t texture;
};

/// Reads faces, strips and unused elements; calls `use` with each row that has corners.
template <typename Cursor, typename Use>
Status read_faces(Cursor* cursor, const PlyElement& element, const Use& use) {
  const FaceColumns columns(element);
  PlyFace face;
  double unused = 0.0;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    bool good = cursor->begin_row();
    for (std::size_t k = 0; good && k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      std::vector<double>* const list = k == columns.corners     ? &face.corners
                                        : k == columns.texcoords ? &face.texcoords
                                                                 : nullptr;
      good = property.count_type ? read_list(cursor, property, list)
                                 : cursor->read(property.type, k == columns.texture ? &face.texture : &unused);
    }
    if (!good || !cursor->end_row()) return bad_row(*cursor, element, i);
    if (columns.corners == element.properties.size()) continue;
    if (Status used = use(face); !used) {
      return std::move(used).error().while_doing(fmt::format("row {} of '{}'", i, printable(element.name)));
    }
  }
  return Done{};
}

template <typename Cursor>
Status read_body(Cursor cursor, const PlyHeader& header, PlyMesh* mesh) {
  TRY(mesh->begin(header));
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      TRY(read_vertices(&cursor, element, mesh));
    } else if (element.name == "face") {
      TRY(mesh->reserve_triangles(element.count));
      TRY(read_faces(&cursor, element, [&](const PlyFace& face) { return mesh->add_polygon(face); }));
    } else if (element.name == "tristrips") {
      TRY(read_faces(&cursor, element, [&](const PlyFace& strip) { return mesh->add_strip(strip.corners); }));
    } else {
      TRY(read_faces(&cursor, element, [](const PlyFace&) { return Done{}; }));
    }
  }
  return Done{};
}

/// Loads the textures of materials whose meshes have texture coordinates; a note names each texture that cannot be
/// read.
void add_textures(const PlyHeader& header, const std::filesystem::path& folder, const ImportLimits& limits,
                  Model* model) {
  if (header.texture_files.empty()) return;
  std::size_t left_bytes = limits.memory_bytes;
  bool has_texcoords = false;
  for (const Mesh& mesh : model->meshes) {
    if (mesh.texcoords[0].empty()) continue;
    has_texcoords = true;
    const auto number = static_cast<std::size_t>(mesh.material);
    auto pixels = read_image(file_beside(folder, header.texture_files[number]),
                             std::min(limits.texture_px, left_bytes / sizeof(std::uint32_t)));
    if (!pixels) {
      model->notes.push_back(fmt::format("{}: its surfaces stay plain", pixels.error().message()));
      continue;
    }
    left_bytes -= pixels->data().size();
    model->materials[number].base_colour_texture.texture = static_cast<int>(model->textures.size());
    model->textures.push_back({*std::move(pixels)});
  }
  if (!has_texcoords) {
    model->notes.push_back(fmt::format("the texture '{}' is not shown: the file has no texture coordinates",
                                       printable(header.texture_files.front())));
  }
}

Result<Model> import_bytes(std::span<const std::byte> file, const std::filesystem::path& folder,
                           const ImportLimits& limits) {
  TRY_ASSIGN(const PlyHeader header, parse_ply_header(file));
  if (holds_splats(header)) return read_splat_ply(file, header, limits);
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
  if (model) add_textures(header, folder, limits, &*model);
  return model;
}

}  // namespace

Result<Model> import_ply(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  Result<Model> model = import_bytes(file.bytes(), path.parent_path(), limits);
  if (!model) return std::move(model).error().while_doing(fmt::format("'{}'", path.string()));
  return model;
}

}  // namespace cyclorama::scene
