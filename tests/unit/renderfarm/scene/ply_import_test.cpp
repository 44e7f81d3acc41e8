// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using testing::HasSubstr;

Result<Model> import_text(const std::string& text, const ImportLimits& limits = {}) {
  const MemoryFile file(text);
  Result<Model> model = import_ply(file.path(), limits);
  if (model) {
    EXPECT_EQ(broken_promise(*model), "");
  }
  return model;
}

std::string complaint(const std::string& text, const ImportLimits& limits = {}) {
  const Result<Model> model = import_text(text, limits);
  if (model) return "";
  EXPECT_EQ(model.error().code(), ErrorCode::kBadData);
  return model.error().message();
}

template <typename T>
void append(std::string* bytes, T value, bool big_endian) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
  bytes->append(raw.data(), raw.size());
}

const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string ascii(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

TEST(PlyImport, a_square_in_ascii_becomes_two_triangles) {
  const auto model = import_text(ascii(kVertices + kFaces, kSquare + "4 0 1 2 3\n"));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes.size(), 1u);
  EXPECT_EQ(model->meshes[0].triangles.size(), 2u);
  EXPECT_EQ(model->meshes[0].positions[2], (std::array<float, 3>{1, 1, 0}));
  EXPECT_TRUE(model->meshes[0].normals.empty());
}

TEST(PlyImport, a_file_without_a_material_is_matte_on_both_sides) {
  const auto model = import_text(ascii(kVertices + kFaces, kSquare + "4 0 1 2 3\n"));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->materials.size(), 1u);
  const Material& material = model->materials[0];
  EXPECT_EQ(material.roughness, 1.0f);
  EXPECT_EQ(material.metallic, 0.0f);
  EXPECT_TRUE(material.double_sided);
}

TEST(PlyImport, both_byte_orders_and_any_types_give_the_same) {
  for (const bool big : {false, true}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 3\nproperty uchar red\nproperty double x\nproperty short y\n"
        "property list uint8 float32 extra\nproperty int z\nproperty uchar green\nproperty ushort blue\n"
        "element face 1\nproperty float quality\nproperty list ushort uchar vertex_index\nend_header\n";
    for (int i = 0; i < 3; ++i) {
      append(&bytes, std::uint8_t{10}, big);
      append(&bytes, 0.5 * i, big);
      append(&bytes, static_cast<std::int16_t>(i == 1 ? -3 : 0), big);
      append(&bytes, std::uint8_t{2}, big);
      append(&bytes, 1.0f, big);
      append(&bytes, 2.0f, big);
      append(&bytes, std::int32_t{i == 2 ? 7 : 0}, big);
      append(&bytes, std::uint8_t{20}, big);
      append(&bytes, std::uint16_t{257 * 30}, big);
    }
    append(&bytes, 1.0f, big);
    append(&bytes, std::uint16_t{3}, big);
    bytes += std::string("\0\1\2", 3);
    const auto model = import_text(bytes);
    ASSERT_TRUE(model.has_value()) << model.error().message();
    const Mesh& mesh = model->meshes[0];
    EXPECT_EQ(mesh.positions[1], (std::array<float, 3>{0.5f, -3.0f, 0.0f}));
    EXPECT_EQ(mesh.positions[2][2], 7.0f);
    EXPECT_EQ(mesh.colours[0], (std::array<std::uint8_t, 4>{10, 20, 30, 255}));
    EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  }
}

TEST(PlyImport, surveyed_coordinates_keep_their_millimetres) {
  const std::string elements = "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n" + kFaces;
  const auto model = import_text(ascii(elements,
                                       "431234.5671 5412345.1234 95.5\n431234.5681 5412345.1234 95.5\n"
                                       "431234.5671 5412345.1244 95.5\n3 0 1 2\n"));
  ASSERT_TRUE(model.has_value());
  const Mesh& mesh = model->meshes[0];
  EXPECT_NEAR(mesh.origin.x() + double{mesh.positions[1][0]}, 431234.5681, 1e-6);
  EXPECT_NEAR(mesh.origin.y() + double{mesh.positions[2][1]}, 5412345.1244, 1e-6);
}

TEST(PlyImport, faces_may_come_before_vertices) {
  const auto model = import_text(ascii(kFaces + kVertices, "3 0 1 3\n" + kSquare));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(model->meshes[0].triangles[0], (std::array<std::uint32_t, 3>{0, 1, 3}));
}

TEST(PlyImport, reverses_every_other_triangle_of_a_strip_and_restarts_at_minus_one) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  const auto model = import_text(ascii(kVertices + strips, kSquare + "9 0 1 3 2 -1 0 1 2 -1\n"));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(model->meshes[0].triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {3, 1, 2}, {0, 1, 2}}));
}

TEST(PlyImport, normals_texture_coordinates_and_float_colours_are_read) {
  const std::string elements =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty float s\nproperty float t\nproperty float red\nproperty float green\n"
      "property float blue\nproperty float alpha\n" +
      kFaces;
  const auto model = import_text(ascii(elements,
                                       "0 0 0 0 0 2 0 0 1 0.5 0 1\n1 0 0 0 0 0 1 0 nan 9 -1 1\n"
                                       "0 1 0 0 0 1 0 0.25 0 0 0 0.5\n3 0 1 2\n"));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.normals[0], (std::array<float, 3>{0, 0, 1}));
  EXPECT_EQ(mesh.normals[1], (std::array<float, 3>{0, 0, 1})) << "a zero normal becomes the triangle's";
  EXPECT_EQ(mesh.texcoords[0][2], (std::array<float, 2>{0.0f, 0.75f})) << "v counts down";
  EXPECT_EQ(mesh.colours[0], (std::array<std::uint8_t, 4>{255, 128, 0, 255}));
  EXPECT_EQ(mesh.colours[1], (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
  EXPECT_EQ(model->materials[0].alpha_mode, AlphaMode::kBlend);
}

TEST(PlyImport, triangles_with_corners_that_are_not_finite_are_left_out_and_counted) {
  const std::string faces = "element face 2\nproperty list uchar int vertex_indices\n";
  const auto model = import_text(ascii(kVertices + faces, "0 0 0\n1 0 0\n1 1 0\nnan 1e300 0\n3 0 1 2\n3 1 2 3\n"));
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].triangles.size(), 1u);
  EXPECT_THAT(model->notes, testing::Contains(HasSubstr("1 triangles have corners that are not finite")));
}

TEST(PlyImport, points_become_coloured_squares_that_cover_the_surface) {
  std::string rows;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 30; ++x) {
      rows += std::to_string(0.1 * x) + " " + std::to_string(0.1 * y) + " " + std::to_string(0.02 * x) + " " +
              std::to_string(8 * x) + " 20 30\n";
    }
  }
  const auto model =
      import_text(ascii("element vertex 600\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                        "property uchar green\nproperty uchar blue\n",
                        rows));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 1200u);
  EXPECT_EQ(mesh.colours.size(), mesh.positions.size());
  EXPECT_EQ(mesh.colours[4 * 31][0], 8);
  EXPECT_THAT(model->notes, testing::Contains(HasSubstr("600 points")));
  // All squares lie in the plane of the points, and are about as large as the points are apart.
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return Eigen::Map<const Eigen::Vector3f>(mesh.positions[t[i]].data()); };
    const Eigen::Vector3f doubled = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    area += 0.5 * double{doubled.norm()};
    EXPECT_NEAR(std::abs(doubled.normalized().dot(Eigen::Vector3f(-0.2f, 0.0f, 1.0f).normalized())), 1.0f, 1e-3f);
  }
  const double covered = 3.0 * 2.0 * std::hypot(1.0, 0.2);
  EXPECT_GT(area, covered);
  EXPECT_LT(area, 4.0 * covered);
}

TEST(PlyImport, points_that_are_few_equal_or_not_finite_are_shown_or_refused) {
  EXPECT_EQ(complaint(ascii(kVertices, kSquare)), "");
  EXPECT_EQ(complaint(ascii(kVertices, "1 1 1\n1 1 1\n1 1 1\n1 1 1\n")), "");
  const auto model = import_text(ascii(kVertices, "0 0 0\nnan 0 0\n1 1 0\n0 1 0\n"));
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].triangles.size(), 6u);
  EXPECT_THAT(complaint(ascii(kVertices, "nan 0 0\nnan 0 0\nnan 0 0\nnan 0 0\n")), HasSubstr("finite"));
  EXPECT_THAT(complaint(ascii(kVertices, kSquare), {.memory_bytes = 100}), HasSubstr("MiB"));
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, kSquare + "2 0 1\n")), HasSubstr("none of its faces"));
}

TEST(PlyImport, an_invalid_index_is_refused_with_its_row) {
  for (const char* const index : {"4", "-1", "1.5", "4294967296", "nan", "1e300"}) {
    EXPECT_THAT(complaint(ascii(kVertices + kFaces, kSquare + "3 0 1 " + index + "\n")),
                testing::AllOf(HasSubstr("row 0 of 'face'"), HasSubstr("refers to vertex")))
        << index;
  }
}

TEST(PlyImport, rows_that_are_too_short_or_too_long_name_their_line) {
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, "0 0 0\n1 0\n1 1 0\n0 1 0\n3 0 1 2\n")), HasSubstr("line 11"));
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, "0 0 0\n1 0 0 7\n1 1 0\n0 1 0\n3 0 1 2\n")), HasSubstr("line 11"));
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, "0 0 0\n1 0 x\n1 1 0\n0 1 0\n3 0 1 2\n")), HasSubstr("not a number"));
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, kSquare + "            ")), HasSubstr("is missing"));
}

TEST(PlyImport, a_header_that_announces_more_than_the_file_holds_is_refused_before_memory_is_taken) {
  for (const char* const count : {"4000000000", "9223372036854775807", "1000"}) {
    EXPECT_THAT(complaint("ply\nformat binary_little_endian 1.0\nelement vertex " + std::string(count) +
                          "\nproperty float x\nproperty float y\nproperty float z\nend_header\n12345678"),
                HasSubstr("cut short"));
  }
}

TEST(PlyImport, every_truncation_of_a_binary_file_is_refused) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + kVertices + kFaces + "end_header\n";
  for (int i = 0; i < 12; ++i) append(&bytes, static_cast<float>(i * i), false);
  bytes += '\3';
  for (const std::int32_t index : {0, 1, 2}) append(&bytes, index, false);
  ASSERT_EQ(complaint(bytes), "");
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_NE(complaint(bytes.substr(0, length)), "") << length;
  }
}

TEST(PlyImport, stray_lines_in_the_header_are_skipped_unless_they_may_declare_something) {
  const std::string rest = kVertices + kFaces + "end_header\n" + kSquare + "4 0 1 2 3\n";
  const auto model = import_text("ply\nformat ascii 1.0\nVCGLIB generated\nScanned in the hall\n" + rest);
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_THAT(model->notes, ::testing::Contains(HasSubstr("2 lines of the PLY header")));
  for (const char* const line : {"propety float quality", "elemnt face 1", "prperty list uchar int corners"}) {
    EXPECT_THAT(complaint("ply\nformat ascii 1.0\n" + std::string(line) + "\n" + rest), HasSubstr("line 3")) << line;
  }
}

TEST(PlyImport, wrong_headers_name_their_line) {
  EXPECT_THAT(complaint("plx\n"), HasSubstr("not a PLY file"));
  EXPECT_THAT(complaint("ply\nformat ascii 1.0\n"), HasSubstr("no end"));
  EXPECT_THAT(complaint("ply\nend_header\n"), HasSubstr("no 'format'"));
  EXPECT_THAT(complaint("ply\nformat zip 1.0\nend_header\n"), HasSubstr("line 2"));
  EXPECT_THAT(complaint("ply\nformat ascii 1.0\nproperty float x\nend_header\n"), HasSubstr("before any element"));
  EXPECT_THAT(complaint(ascii("element vertex -1\nproperty float x\n", "")), HasSubstr("line 3"));
  EXPECT_THAT(complaint(ascii("element vertex 1\nproperty quad x\n", "")), HasSubstr("type 'quad'"));
  EXPECT_THAT(complaint(ascii("element vertex 1\nproperty list float int x\n", "")), HasSubstr("counts a list"));
  EXPECT_THAT(complaint(ascii("element vertex 0\n", "")), HasSubstr("no properties"));
  EXPECT_THAT(complaint(ascii("element vertex 0\nproperty float x\n", "")), HasSubstr("no x, y and z"));
  EXPECT_THAT(complaint(ascii(kVertices + kVertices, kSquare + kSquare)), HasSubstr("two elements 'vertex'"));
  EXPECT_THAT(complaint(ascii("element apple 0\nproperty float x\n", "")), HasSubstr("no element 'vertex'"));
  EXPECT_THAT(complaint(ascii("wibble float x\n", "")), HasSubstr("'wibble'"));
}

TEST(PlyImport, keeps_memory_limits) {
  EXPECT_THAT(complaint(ascii(kVertices + kFaces, kSquare + "3 0 1 2\n"), {.memory_bytes = 50}), HasSubstr("limit"));
}

TEST(PlyImport, distinguishes_a_missing_file_from_a_folder) {
  EXPECT_EQ(import_ply("/nowhere.ply", {}).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(import_ply("/", {}).error().code(), ErrorCode::kBadData);
}

TEST(PlyImport, reads_a_million_scanned_triangles_with_colours) {
  CYCLORAMA_SHARED_DATA(file, "relics/buddha_head_1m.ply");
  const Result<Model> model = import_ply(file, ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes.size(), 1u);
  EXPECT_EQ(model->meshes[0].triangles.size(), 1'050'000u);
  EXPECT_EQ(model->meshes[0].colours.size(), model->meshes[0].positions.size());
  EXPECT_EQ(broken_promise(*model), "");
}

}  // namespace
}  // namespace cyclorama::scene
