// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/image/png.h"
#include "renderfarm/scene/model.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;

Result<Model> import_text(const std::string& text, const ImportLimits& limits = {}) {
  const MemoryFile file(text);
  Result<Model> model = import_obj(file.path(), limits);
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

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class ObjFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("obj_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  Result<Model> import_with_mtl(const std::string& mtl) const {
    write("a.mtl", mtl);
    write("a.obj", "mtllib a.mtl\n" + kTriangle + "usemtl m\nf 1 2 3\n");
    Result<Model> model = import_obj(folder_ / "a.obj", {});
    if (model) {
      EXPECT_EQ(broken_promise(*model), "");
    }
    return model;
  }
  /// Returns the triangle's material.
  Material material(const std::string& mtl) const {
    const auto model = import_with_mtl(mtl);
    EXPECT_TRUE(model.has_value());
    return model ? model->materials[static_cast<std::size_t>(model->meshes[0].material)] : Material{};
  }
  std::filesystem::path folder_;
};

TEST(ObjImport, numbers_of_lists_that_the_file_lacks_are_ignored_with_a_note) {
  const auto model = import_text(kTriangle + "f 1/1/1 2/2/2 3/3/3\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_TRUE(model->meshes[0].texcoords[0].empty());
  EXPECT_TRUE(model->meshes[0].normals.empty());
  EXPECT_THAT(model->notes, Contains(HasSubstr("of which the file has none")));
  EXPECT_FALSE(import_text(kTriangle + "vt 0 0\nf 1/1 2/2 3/3\n").has_value()) << "a list that is too short is damage";
}

TEST(ObjImport, equal_corners_become_one_vertex_and_others_do_not) {
  const auto model = import_text(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvn 0 0 2\n"
      "f 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\nf 1/2/1 2/1/1 3/1/1\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.texcoords[0].back(), (std::array<float, 2>{1.0f, 0.75f})) << "v counts down";
  EXPECT_EQ(mesh.normals[0], (std::array<float, 3>{0, 0, 1}));
}

TEST(ObjImport, negative_indices_count_backwards_and_faces_may_come_first) {
  const auto model = import_text(kTriangle + "f -3 -2 -1\nv 5 5 5\nf -1 -2 -3\n");
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].positions[model->meshes[0].triangles[1][0]], (std::array<float, 3>{5, 5, 5}));
  EXPECT_TRUE(import_text("f 1 2 3\n" + kTriangle).has_value());
}

TEST(ObjImport, dialects_are_read) {
  for (const char* const faces : {"f 1// 2// 3//", "f 1/ 2/ 3/", "  f\t1  2   3  ", "f 1 \\\n2 \\\n3", "f 1 2 3 # end",
                                  "fo 1 2 3", "g An f\no x\ns 1\nf 1 2 3\nvp 1 2", "f 1 2 3\r\n"}) {
    const auto model = import_text(kTriangle + faces);
    ASSERT_TRUE(model.has_value()) << faces << ": " << model.error().message();
    EXPECT_EQ(model->meshes[0].triangles.size(), 1u) << faces;
  }
}

TEST(ObjImport, utf_16_of_both_orders_and_byte_order_marks_are_read) {
  const std::string text = kTriangle + "f 1 2 3\n";
  EXPECT_TRUE(import_text("\xEF\xBB\xBF" + text).has_value());
  std::string big = "\xFE\xFF";
  std::string little = "\xFF\xFE";
  for (const char c : text) {
    big += std::string({'\0', c});
    little += std::string({c, '\0'});
  }
  EXPECT_EQ(complaint(big), "");
  EXPECT_EQ(complaint(little), "");
  EXPECT_EQ(complaint(little + "\x3d\xd8"), "");  // Half of a surrogate pair at the end.
}

TEST(ObjImport, colours_after_positions_are_read) {
  const auto model = import_text("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 nan 2 -1\nf 1 2 3\n");
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].colours[0], (std::array<std::uint8_t, 4>{255, 128, 0, 255}));
  EXPECT_EQ(model->meshes[0].colours[1], (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
  EXPECT_EQ(model->meshes[0].colours[2], (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
}

TEST(ObjImport, surveyed_coordinates_keep_their_millimetres) {
  const auto model = import_text(
      "v 431234.5671 95.5 5412345.1234\nv 431234.5681 95.5 5412345.1234\n"
      "v 431234.5671 95.501 5412345.1234\nf 1 2 3\n");
  ASSERT_TRUE(model.has_value());
  const Mesh& mesh = model->meshes[0];
  EXPECT_NEAR(mesh.origin.x() + double{mesh.positions[1][0]}, 431234.5681, 1e-6);
}

TEST(ObjImport, wrong_indices_name_their_line) {
  for (const char* const face : {"f 1 2 4", "f 0 1 2", "f -4 1 2", "f 1/2 2 3", "f 1//2 2 3", "f 1 2 x", "f /1 2 3",
                                 "f 1 2 99999999999999999999", "f 1.5 2 3"}) {
    EXPECT_THAT(complaint(kTriangle + "vt 0 0\nvn 0 0 1\n" + face + "\n"), HasSubstr("line 6")) << face;
  }
}

TEST(ObjImport, wrong_vertices_name_their_line) {
  EXPECT_THAT(complaint("v 0 0\nf 1 1 1\n"), HasSubstr("line 1"));
  EXPECT_THAT(complaint("v 0 0 x\nf 1 1 1\n"), HasSubstr("line 1"));
  EXPECT_THAT(complaint("v 0 0 0\nvn 1 2\nf 1 1 1\n"), HasSubstr("line 2"));
}

TEST(ObjImport, unsupported_elements_are_left_out_and_noted) {
  const auto model = import_text(kTriangle + "v nan 0 0\nf 1 2 3\nf 1 2 4\nf 1 2\nl 1 2\np 1\nv 3.1+e2 0 0\n");
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].triangles.size(), 1u);
  EXPECT_THAT(model->notes, Contains(HasSubstr("not finite")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("fewer than three corners")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("lines or points")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("other characters")));
}

TEST(ObjImport, points_without_faces_are_shown_as_squares_with_their_colours) {
  const auto model = import_text("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv nan 0 0 1 1 1\np 1 2\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(broken_promise(*model), "");
  EXPECT_EQ(model->meshes.at(0).triangles.size(), 6u) << "two for each point that is finite";
  EXPECT_EQ(model->meshes[0].colours.at(4), (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
  EXPECT_THAT(model->notes, Contains(HasSubstr("shown as small squares")));
}

TEST(ObjImport, a_file_without_faces_and_points_is_refused_with_a_remedy) {
  EXPECT_THAT(complaint(""), HasSubstr("no faces"));
  EXPECT_THAT(complaint("v nan 0 0\nf 1 1 1\n"), HasSubstr("finite corners"));
}

TEST(ObjImport, keeps_memory_limits) {
  EXPECT_THAT(complaint(kTriangle + "f 1 2 3\n", {.memory_bytes = 64}), HasSubstr("larger than a scene may be"));
}

TEST_F(ObjFolder, one_mesh_is_made_for_each_material) {
  write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  write("a.obj",
        "mtllib a.mtl\n" + kTriangle + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\nf 3 2 1\nusemtl red\nf 3 2 1\n");
  const auto model = import_obj(folder_ / "a.obj", {});
  ASSERT_TRUE(model.has_value());
  ASSERT_EQ(model->meshes.size(), 2u);
  EXPECT_EQ(model->meshes[0].triangles.size(), 2u);
  EXPECT_EQ(model->materials[static_cast<std::size_t>(model->meshes[1].material)].name, "blue");
  EXPECT_EQ(model->instances.size(), 2u);
}

TEST_F(ObjFolder, materials_are_converted_as_closely_as_possible) {
  const Material m = material("newmtl m\nKd 0.5 0.25 0\nKe 1 2 3\nNs 98\nKs 1 1 1\nd 0.5\nmap_bump x.png\n");
  EXPECT_EQ(m.base_colour, Eigen::Vector4f(0.5f, 0.25f, 0.0f, 0.5f));
  EXPECT_EQ(m.emissive, Eigen::Vector3f(1, 2, 3));
  EXPECT_NEAR(m.roughness, std::sqrt(std::sqrt(0.02)), 1e-6);
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.alpha_mode, AlphaMode::kBlend);
  EXPECT_EQ(material("newmtl m\nTr 0.25\n").base_colour[3], 0.75f);
  EXPECT_EQ(material("newmtl m\nPr 0.2\nPm 1\n").metallic, 1.0f);
  EXPECT_EQ(material("newmtl m\nPc 0.75\nPcr 0.5\n").clearcoat, 0.75f);
  EXPECT_EQ(material("newmtl m\nPc 0.75\nPcr 0.5\n").clearcoat_roughness, 0.5f);
  EXPECT_EQ(material("newmtl m\nd 0\n").base_colour[3], 1.0f);
  EXPECT_EQ(material("newmtl m\nKd 0.3\nKd x\nKd\nNs nan\n").base_colour[1], 0.3f);
}

TEST_F(ObjFolder, textures_are_found_despite_foreign_paths) {
  ASSERT_TRUE(write_png(folder_ / "t.png", RgbImage(2, 2, 99)).has_value());
  for (const char* const name : {"t.png", "-s 1 1 1 -o 0 0 t.png", "-clamp on t.png", "-bm 0.5 t.png",
                                 "C:\\Users\\me\\t.png", "/home/me/t.png", "../../t.png", "./t.png"}) {
    const auto model = import_with_mtl(std::string("newmtl m\nKd 0 0 0\nmap_Kd ") + name + "\n");
    ASSERT_TRUE(model.has_value());
    ASSERT_EQ(model->textures.size(), 1u) << name;
    const Material& m = model->materials[static_cast<std::size_t>(model->meshes[0].material)];
    EXPECT_EQ(m.base_colour_texture.texture, 0);
    EXPECT_EQ(m.base_colour[0], 1.0f) << "a black factor would hide the picture";
  }
}

TEST_F(ObjFolder, a_missing_texture_or_material_file_is_noted_and_the_model_shown) {
  const auto model = import_with_mtl("newmtl m\nmap_Kd gone.png\n");
  ASSERT_TRUE(model.has_value());
  EXPECT_THAT(model->notes, Contains(HasSubstr("gone.png")));
  const auto without = import_text("mtllib gone.mtl\nusemtl x\n" + kTriangle + "f 1 2 3\n");
  ASSERT_TRUE(without.has_value());
  EXPECT_THAT(without->notes, Contains(HasSubstr("'gone.mtl' is missing")));
  EXPECT_THAT(without->notes, Contains(HasSubstr("'x' is in no material file")));
}

TEST_F(ObjFolder, a_material_file_may_be_named_after_its_use) {
  write("a.mtl", "newmtl m\nKd 0.5 0.25 0\n");
  write("a.obj", kTriangle + "usemtl m\nf 1 2 3\ng late\nmtllib a.mtl\n");
  const auto model = import_obj(folder_ / "a.obj", {});
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->materials[static_cast<std::size_t>(model->meshes[0].material)].base_colour[1], 0.25f);
  EXPECT_TRUE(model->notes.empty());
}

TEST_F(ObjFolder, a_material_file_may_have_blanks_in_its_name) {
  write("my stone.mtl", "newmtl m\nKd 0.5 0.5 0.5\n");
  write("a.obj", "mtllib my stone.mtl\n" + kTriangle + "usemtl m\nf 1 2 3\n");
  const auto model = import_obj(folder_ / "a.obj", {});
  ASSERT_TRUE(model.has_value());
  EXPECT_TRUE(model->notes.empty());
}

}  // namespace
}  // namespace cyclorama::scene
