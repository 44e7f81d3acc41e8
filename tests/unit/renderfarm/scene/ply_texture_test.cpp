// SPDX-License-Identifier: Apache-2.0
// Texture coordinates for each corner of a face, and textures beside the file.
#include <gmock/gmock.h>

#include <fstream>

#include "common/image/png.h"
#include "renderfarm/scene/model.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using ::testing::HasSubstr;

const std::string kSquare =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
    "property list uchar int vertex_indices\nproperty list uchar float texcoord\n";
const std::string kVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

class PlyTextures : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("ply_texture_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(write_png(folder_ / "skin.png", RgbImage(3, 2, 90)).has_value());
    ASSERT_TRUE(write_png(folder_ / "face.png", RgbImage(5, 4, 30)).has_value());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<Model> import(const std::string& comments, const std::string& elements, const std::string& body) {
    std::ofstream(folder_ / "scan.ply") << "ply\nformat ascii 1.0\n" << comments << elements << "end_header\n" << body;
    Result<Model> model = import_ply(folder_ / "scan.ply", {});
    if (model) {
      EXPECT_EQ(broken_promise(*model), "");
    }
    return model;
  }

  std::filesystem::path folder_;
};

TEST_F(PlyTextures, corners_with_the_same_coordinates_share_a_vertex_and_others_do_not) {
  const auto model = import("comment TextureFile skin.png\n", kSquare,
                            kVertices + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 0.25 0 1\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.positions.size(), 5u) << "vertex 2 has two places in the texture";
  EXPECT_EQ(mesh.triangles[0][0], mesh.triangles[1][0]);
  const std::uint32_t seam = mesh.triangles[1][1];
  EXPECT_NE(seam, mesh.triangles[0][2]);
  EXPECT_EQ(mesh.positions[seam], (std::array<float, 3>{1, 1, 0}));
  EXPECT_EQ(mesh.texcoords[0][seam], (std::array<float, 2>{0.5f, 0.75f})) << "v counts down";
  ASSERT_EQ(model->textures.size(), 1u);
  EXPECT_EQ(model->materials[0].base_colour_texture.texture, 0);
  EXPECT_EQ(model->textures[0].pixels.width(), 3);
  EXPECT_THAT(model->notes, ::testing::IsEmpty());
}

TEST_F(PlyTextures, a_polygon_is_cut_with_its_coordinates) {
  const auto model =
      import("comment TextureFile skin.png\n", kSquare, kVertices + "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n2 0 1 0\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_EQ(mesh.texcoords[0][i], (std::array<float, 2>{mesh.positions[i][0], 1.0f - mesh.positions[i][1]}));
  }
}

TEST_F(PlyTextures, each_texture_has_a_mesh_of_its_own) {
  const auto model =
      import("comment TextureFile skin.png\ncomment TextureFile face.png\n", kSquare + "property int texnumber\n",
             kVertices + "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 6 0 0 1 1 0 1 0\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes.size(), 2u);
  EXPECT_EQ(model->meshes[0].positions.size(), 3u);
  const auto width_of = [&](std::size_t mesh) {
    const Material& material = model->materials[static_cast<std::size_t>(model->meshes[mesh].material)];
    return model->textures[static_cast<std::size_t>(material.base_colour_texture.texture)].pixels.width();
  };
  EXPECT_EQ(width_of(0), 3);
  EXPECT_EQ(width_of(1), 5);
}

TEST_F(PlyTextures, coordinates_of_vertices_use_the_texture_too) {
  const std::string elements =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
      "element face 1\nproperty list uchar int vertex_indices\n";
  const auto model = import("comment TextureFile skin.png\n", elements, "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(model->materials[0].base_colour_texture.texture, 0);
}

TEST_F(PlyTextures, a_texture_that_is_missing_or_elsewhere_is_a_note) {
  const std::string body = kVertices + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n";
  const auto missing = import("comment TextureFile lost.png\n", kSquare, body);
  ASSERT_TRUE(missing.has_value()) << missing.error().message();
  EXPECT_THAT(missing->notes, ::testing::ElementsAre(HasSubstr("lost.png")));
  EXPECT_EQ(missing->materials[0].base_colour_texture.texture, -1);
  // A path of another computer is reduced to its file name, beside the file; nothing outside of the folder is read.
  const auto foreign = import("comment TextureFile C:\\scans\\skin.png\n", kSquare, body);
  ASSERT_TRUE(foreign.has_value()) << foreign.error().message();
  EXPECT_EQ(foreign->textures.size(), 1u);
  const auto outside = import("comment TextureFile ../../etc/passwd\n", kSquare, body);
  ASSERT_TRUE(outside.has_value()) << outside.error().message();
  EXPECT_TRUE(outside->textures.empty());
}

TEST_F(PlyTextures, faces_with_and_without_coordinates_together_show_none) {
  const auto model =
      import("comment TextureFile skin.png\n", kSquare, kVertices + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 0\n");
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_THAT(model->notes, ::testing::Contains(HasSubstr("others none")));
}

TEST_F(PlyTextures, damaged_coordinates_are_refused_with_their_row) {
  const auto few = import("", kSquare, kVertices + "3 0 1 2 5 0 0 1 0 1\n3 0 2 3 6 0 0 1 1 0 1\n");
  ASSERT_FALSE(few.has_value());
  EXPECT_THAT(few.error().message(), HasSubstr("row 0 of 'face': has 5 numbers of texture coordinates for 3 corners"));
  const auto far = import("comment TextureFile skin.png\n", kSquare + "property int texnumber\n",
                          kVertices + "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 1 1 0 1 1\n");
  ASSERT_FALSE(far.has_value());
  EXPECT_THAT(far.error().message(), HasSubstr("row 1 of 'face': has the texture 1; the header names 1"));
}

}  // namespace
}  // namespace cyclorama::scene
