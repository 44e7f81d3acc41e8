// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/ply_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "common/geometry/polygon.h"
#include "renderfarm/scene/mesh_repair.h"
#include "renderfarm/scene/point_cloud.h"

namespace cyclorama::scene {
namespace {

struct RoleName {
  std::string_view name;
  PlyRole role;
};
constexpr RoleName kRoleNames[] = {{"x", kX},
                                   {"y", kY},
                                   {"z", kZ},
                                   {"nx", kNx},
                                   {"ny", kNy},
                                   {"nz", kNz},
                                   {"normal_x", kNx},
                                   {"normal_y", kNy},
                                   {"normal_z", kNz},
                                   {"s", kU},
                                   {"t", kV},
                                   {"u", kU},
                                   {"v", kV},
                                   {"texture_u", kU},
                                   {"texture_v", kV},
                                   {"red", kRed},
                                   {"green", kGreen},
                                   {"blue", kBlue},
                                   {"alpha", kAlpha},
                                   {"r", kRed},
                                   {"g", kGreen},
                                   {"b", kBlue},
                                   {"a", kAlpha},
                                   {"diffuse_red", kRed},
                                   {"diffuse_green", kGreen},
                                   {"diffuse_blue", kBlue},
                                   {"diffuse_alpha", kAlpha}};

double scale_of_colour(PlyType type) {
  if (is_float(type)) return 255.0;
  if (type == PlyType::kUint16 || type == PlyType::kInt16) return 1.0 / 257.0;
  return 1.0;
}

}  // namespace

PlyVertexLayout::PlyVertexLayout(const PlyElement& vertex) {
  for (const PlyProperty& property : vertex.properties) {
    PlyRole role = kNoRole;
    for (const RoleName& known : kRoleNames) {
      if (!property.count_type && known.name == property.name) role = known.role;
    }
    if (role != kNoRole && has_[role]) role = kNoRole;  // Of two properties with the same role, the first is used.
    roles_.push_back(role);
    has_[role] = true;
    colour_scale_[role] = scale_of_colour(property.type);
    is_double_ = is_double_ || (role <= kZ && property.type == PlyType::kFloat64);
  }
}

Status PlyMesh::check_memory(std::uint64_t triangles) const {
  const std::size_t each =
      sizeof(mesh_.triangles[0]) + (texcoords_.size() > 0 ? PlyTexcoords::kBytesPerTriangle : std::size_t{0});
  if (vertex_count_ * bytes_per_vertex_ + triangles * each <= limit_bytes_) return Done{};
  return Error(ErrorCode::kBadData,
               fmt::format("it needs more than the {} MiB that a scene may take; raise the limit or "
                           "reduce the mesh",
                           limit_bytes_ >> 20));
}

Status PlyMesh::begin(const PlyHeader& header) {
  const PlyElement* vertex = nullptr;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    if (vertex != nullptr) return Error(ErrorCode::kBadData, "it has two elements 'vertex'; one is accepted");
    vertex = &element;
  }
  if (vertex == nullptr) return Error(ErrorCode::kBadData, "it has no element 'vertex', and so no geometry");
  const PlyVertexLayout layout(*vertex);
  if (!layout.has(kX) || !layout.has(kY) || !layout.has(kZ)) {
    return Error(ErrorCode::kBadData, "its vertices have no x, y and z");
  }
  if (vertex->count > std::numeric_limits<std::uint32_t>::max()) {
    return Error(ErrorCode::kBadData, fmt::format("it has {} vertices; split it into several files", vertex->count));
  }
  vertex_count_ = vertex->count;
  texture_count_ = header.texture_files.size();
  bytes_per_vertex_ =
      12u + (layout.has_normal() ? 12u : 0u) + (layout.has_texcoord() ? 8u : 0u) + (layout.has_colour() ? 4u : 0u);
  TRY(check_memory(0));
  mesh_.positions.reserve(vertex_count_);
  if (layout.has_normal()) mesh_.normals.reserve(vertex_count_);
  if (layout.has_texcoord()) mesh_.texcoords[0].reserve(vertex_count_);
  if (layout.has_colour()) mesh_.colours.reserve(vertex_count_);
  return Done{};
}

void PlyMesh::add_vertex(const PlyVertexLayout& layout, const std::array<double, kNoRole + 1>& row) {
  Eigen::Vector3d p(row[kX], row[kY], row[kZ]);
  if (!is_usable(p)) {
    is_unusable_.resize(vertex_count_, false);
    is_unusable_[mesh_.positions.size()] = true;
    p = mesh_.origin;
  } else if (!has_origin_ && layout.is_double()) {
    mesh_.origin = origin_near(p);
    has_origin_ = true;
  }
  const Eigen::Vector3f near_origin = (p - mesh_.origin).cast<float>();
  mesh_.positions.push_back({near_origin.x(), near_origin.y(), near_origin.z()});
  if (layout.has_normal()) {
    mesh_.normals.push_back({finite_float(row[kNx]), finite_float(row[kNy]), finite_float(row[kNz])});
  }
  if (layout.has_texcoord()) {
    mesh_.texcoords[0].push_back({finite_float(row[kU]), finite_float(1.0 - row[kV])});
  }
  if (layout.has_colour()) {
    const auto byte_of = [&](PlyRole role) { return to_byte(row[role] * layout.colour_scale(role)); };
    const std::uint8_t alpha = layout.has(kAlpha) ? byte_of(kAlpha) : std::uint8_t{255};
    has_alpha_ = has_alpha_ || (alpha != 255 && alpha != 0);
    mesh_.colours.push_back({byte_of(kRed), byte_of(kGreen), byte_of(kBlue), alpha});
  }
}

Status PlyMesh::reserve_triangles(std::uint64_t count) {
  has_faces_ = has_faces_ || count > 0;
  TRY(check_memory(mesh_.triangles.size() + count));
  mesh_.triangles.reserve(mesh_.triangles.size() + count);
  return Done{};
}

Result<std::uint32_t> PlyMesh::index_of(double corner) const {
  if (corner >= 0.0 && corner < static_cast<double>(vertex_count_) && corner == std::floor(corner)) {
    return static_cast<std::uint32_t>(corner);
  }
  return Error(ErrorCode::kBadData,
               fmt::format("refers to vertex {} of {} (from 0); export the file again", corner, vertex_count_));
}

Status PlyMesh::add_texcoords(const PlyFace& face) {
  const std::size_t corners = indices_.size();
  if (face.texcoords.size() != 2 * corners) {
    return Error(ErrorCode::kBadData,
                 fmt::format("has {} numbers of texture coordinates for {} corners; export the file again",
                             face.texcoords.size(), corners));
  }
  const double last = static_cast<double>(std::max<std::size_t>(texture_count_, 1) - 1);
  if (!(face.texture >= 0.0 && face.texture <= last && face.texture == std::floor(face.texture))) {
    return Error(ErrorCode::kBadData,
                 fmt::format("has the texture {}; the header names {} (from 0)", face.texture, texture_count_));
  }
  for (const auto& piece : pieces_) {
    PlyCorners uv;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = 2 * piece[k];
      uv[k] = {finite_float(face.texcoords[at]), finite_float(face.texcoords[at + 1])};
    }
    texcoords_.add(uv, static_cast<std::uint32_t>(face.texture));
  }
  return Done{};
}

Status PlyMesh::add_polygon(const PlyFace& face) {
  indices_.clear();
  for (const double corner : face.corners) {
    TRY_ASSIGN(const std::uint32_t index, index_of(corner));
    indices_.push_back(index);
  }
  pieces_.clear();
  if (indices_.size() == 3) {
    pieces_.push_back({0, 1, 2});
  } else if (indices_.size() < 3) {
    ++polygons_without_area_;
  } else {
    corners_.clear();
    for (const std::uint32_t index : indices_) {
      // If faces precede vertices, positions are not known yet; they are taken as equal, so that the polygon is divided
      // as a fan.
      const bool known = index < mesh_.positions.size();
      const auto& p = known ? mesh_.positions[index] : std::array<float, 3>{};
      corners_.push_back(Eigen::Vector3f(p[0], p[1], p[2]).cast<double>());
    }
    triangulate(corners_, &pieces_);
  }
  for (const auto& piece : pieces_) {
    mesh_.triangles.push_back({indices_[piece[0]], indices_[piece[1]], indices_[piece[2]]});
  }
  if (!face.texcoords.empty()) TRY(add_texcoords(face));
  return check_memory(mesh_.triangles.size());
}

Status PlyMesh::add_strip(std::span<const double> corners) {
  has_faces_ = true;
  indices_.clear();
  for (const double corner : corners) {
    if (corner == -1.0) {
      indices_.clear();
      continue;
    }
    TRY_ASSIGN(const std::uint32_t index, index_of(corner));
    indices_.push_back(index);
    const std::size_t n = indices_.size();
    if (n < 3) continue;
    const bool odd = n % 2 == 0;
    const std::uint32_t a = indices_[n - 3];
    const std::uint32_t b = indices_[n - 2];
    if (a == b || b == index || a == index) continue;  // Repeated corners join strips.
    mesh_.triangles.push_back({odd ? b : a, odd ? a : b, index});
  }
  return check_memory(mesh_.triangles.size());
}

Status PlyMesh::show_points(std::vector<std::string>* notes) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
    if (!is_unusable_.empty() && is_unusable_[i]) continue;
    mesh_.positions[kept] = mesh_.positions[i];
    if (!mesh_.normals.empty()) mesh_.normals[kept] = mesh_.normals[i];
    if (!mesh_.colours.empty()) mesh_.colours[kept] = mesh_.colours[i];
    ++kept;
  }
  if (kept < mesh_.positions.size()) {
    notes->push_back(fmt::format("{} points are not finite: left out", mesh_.positions.size() - kept));
  }
  mesh_.positions.resize(kept);
  if (!mesh_.normals.empty()) mesh_.normals.resize(kept);
  if (!mesh_.colours.empty()) mesh_.colours.resize(kept);
  is_unusable_.clear();
  return scene::show_points(bytes_per_vertex_, limit_bytes_, &mesh_, notes);
}

Result<Model> PlyMesh::finish() && {
  Model model;
  if (mesh_.triangles.empty() && !has_faces_) TRY(show_points(&model.notes));
  if (mesh_.triangles.empty()) return Error(ErrorCode::kBadData, "none of its faces is a triangle with an area");
  const std::size_t before = mesh_.triangles.size();
  if (texcoords_.size() == before) {
    model.meshes = texcoords_.split(mesh_, is_unusable_);
  } else {
    if (texcoords_.size() > 0) {
      model.notes.emplace_back("some faces have texture coordinates and others none: no texture is shown");
    }
    std::erase_if(mesh_.triangles, [&](const std::array<std::uint32_t, 3>& t) {
      return !is_unusable_.empty() && (is_unusable_[t[0]] || is_unusable_[t[1]] || is_unusable_[t[2]]);
    });
    model.meshes.push_back(std::move(mesh_));
  }
  std::size_t left = 0;
  for (const Mesh& mesh : model.meshes) left += mesh.triangles.size();
  if (left == 0) return Error(ErrorCode::kBadData, "none of its triangles has finite corners");
  if (left < before) {
    model.notes.push_back(fmt::format("{} triangles have corners that are not finite: left out", before - left));
  }
  if (polygons_without_area_ > 0) {
    model.notes.push_back(fmt::format("{} faces have fewer than three corners: left out", polygons_without_area_));
  }
  Material material = scan_material();
  if (has_alpha_) material.alpha_mode = AlphaMode::kBlend;
  model.materials.resize(std::max<std::size_t>(texture_count_, 1), material);
  for (Mesh& mesh : model.meshes) {
    repair_normals(&mesh);
    model.instances.push_back({static_cast<int>(model.instances.size()), Eigen::Affine3d::Identity()});
  }
  return model;
}

}  // namespace cyclorama::scene
