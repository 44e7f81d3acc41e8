// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/splat_ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "common/base/text.h"
#include "renderfarm/scene/ply_cursor.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

std::size_t column_of(const PlyElement& vertex, std::string_view name) {
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    if (vertex.properties[i].name == name) return i;
  }
  return kNoColumn;
}

Error bad_splats(std::string what) { return Error(ErrorCode::kBadData, std::move(what)); }

/// Indices of the columns of a row, by meaning.
struct SplatColumns {
  std::array<std::size_t, 3> position{};
  std::array<std::size_t, 3> scale{};
  std::array<std::size_t, 4> rotation{};
  std::size_t opacity = kNoColumn;
  std::vector<std::array<std::size_t, 3>> coefficients;
  int degree = 0;

  static Result<SplatColumns> of(const PlyElement& vertex) {
    SplatColumns columns;
    const auto find = [&](const std::string& name, std::size_t* ret_column) -> Status {
      *ret_column = column_of(vertex, name);
      if (*ret_column != kNoColumn) return Done{};
      return bad_splats(fmt::format("its splats have no '{}'; export it again", name));
    };
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      TRY(find(kAxes[i], &columns.position[i]));
      TRY(find(fmt::format("scale_{}", i), &columns.scale[i]));
    }
    for (std::size_t i = 0; i < 4; ++i) TRY(find(fmt::format("rot_{}", i), &columns.rotation[i]));
    TRY(find("opacity", &columns.opacity));
    std::size_t rest = 0;
    while (column_of(vertex, fmt::format("f_rest_{}", rest)) != kNoColumn) ++rest;
    while (columns.degree < kMaxSplatDegree && rest > columns.rest_count()) ++columns.degree;
    if (rest != columns.rest_count()) {
      return bad_splats(fmt::format("its splats have {} coefficients 'f_rest'; 0, 9, 24 or 45 are expected", rest));
    }
    // The file has first all coefficients of red, then those of green, then those of blue.
    const std::size_t each = rest / 3;
    columns.coefficients.resize(1 + each);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      TRY(find(fmt::format("f_dc_{}", channel), &columns.coefficients[0][channel]));
      for (std::size_t i = 0; i < each; ++i) {
        TRY(find(fmt::format("f_rest_{}", channel * each + i), &columns.coefficients[1 + i][channel]));
      }
    }
    return columns;
  }

 private:
  [[nodiscard]] std::size_t rest_count() const { return 3 * static_cast<std::size_t>((degree + 1) * (degree + 1) - 1); }
};

template <typename Cursor>
Status read_rows(Cursor cursor, const PlyElement& vertex, const SplatColumns& columns, std::size_t* ret_left_out,
                 SplatCloud* cloud) {
  std::vector<double> row(vertex.properties.size());
  std::vector<std::array<float, 3>> coefficients(columns.coefficients.size());
  for (std::uint64_t i = 0; i < vertex.count; ++i) {
    bool good = cursor.begin_row();
    for (std::size_t k = 0; good && k < row.size(); ++k) good = cursor.read(vertex.properties[k].type, &row[k]);
    if (!good || !cursor.end_row()) return bad_splats(fmt::format("row {} of 'vertex': {}", i, cursor.what()));
    SplatValues values;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      values.position[static_cast<int>(axis)] = row[columns.position[axis]];
      values.scale[static_cast<int>(axis)] = std::exp(row[columns.scale[axis]]);
    }
    values.rotation = Eigen::Quaterniond(row[columns.rotation[0]], row[columns.rotation[1]], row[columns.rotation[2]],
                                         row[columns.rotation[3]]);
    values.opacity = 1.0 / (1.0 + std::exp(-row[columns.opacity]));
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) coefficients[k][c] = static_cast<float>(row[columns.coefficients[k][c]]);
    }
    if (!add_splat(values, coefficients, cloud)) ++*ret_left_out;
  }
  return Done{};
}

}  // namespace

bool holds_splats(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
    return element.name == "vertex" && column_of(element, "f_dc_0") != kNoColumn;
  });
}

Result<Model> read_splat_ply(std::span<const std::byte> file, const PlyHeader& header, const ImportLimits& limits) {
  const PlyElement& vertex = header.elements.front();
  const auto is_list = [](const PlyProperty& property) { return property.count_type.has_value(); };
  if (vertex.name != "vertex" || std::any_of(vertex.properties.begin(), vertex.properties.end(), is_list)) {
    return bad_splats("its splats are not the first rows of the file, or have lists; export it again");
  }
  TRY_ASSIGN(const SplatColumns columns, SplatColumns::of(vertex));
  if (vertex.count > limits.memory_bytes / bytes_per_splat(columns.degree)) {
    return bad_splats(
        fmt::format("its {} splats of {} bytes need more than the {} MiB that a scene may take; raise the limit",
                    vertex.count, bytes_per_splat(columns.degree), limits.memory_bytes >> 20));
  }
  Model model;
  model.materials.emplace_back();
  SplatCloud cloud;
  cloud.degree = columns.degree;
  cloud.T_model_cloud.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  std::size_t left_out = 0;
  constexpr bool kIsLittle = std::endian::native == std::endian::little;
  if (header.encoding == PlyEncoding::kAscii) {
    TRY(read_rows(PlyTextCursor(file, header), vertex, columns, &left_out, &cloud));
  } else if ((header.encoding == PlyEncoding::kLittleEndian) == kIsLittle) {
    TRY(read_rows(PlyBinaryCursor<false>(file, header), vertex, columns, &left_out, &cloud));
  } else {
    TRY(read_rows(PlyBinaryCursor<true>(file, header), vertex, columns, &left_out, &cloud));
  }
  if (cloud.size() == 0) return bad_splats("none of its splats can be seen");
  if (left_out > 0) model.notes.push_back(note_of_left_out(left_out));
  model.splats.push_back(std::move(cloud));
  return model;
}

}  // namespace cyclorama::scene
