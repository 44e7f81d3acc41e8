// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/ply_writer.h"

#include <gmock/gmock.h>

#include "common/base/file.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::generator {
namespace {

class PlyWriter : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "ply_writer.XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

const std::array<Vertex, 4> kVertices = {{{{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {1, 2, 3}},
                                          {{1.5f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {255, 0, 128}},
                                          {{0.0f, -2.5f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0, 0, 0}},
                                          {{0.0f, 0.0f, 3.25f}, {1.0f, 0.0f, 0.0f}, {9, 8, 7}}}};
const std::array<Triangle, 2> kTriangles = {{{0, 1, 2}, {3, 2, 1}}};

TEST_F(PlyWriter, writes_files_that_the_importer_reads) {
  const GeometryCounts counts{kVertices.size(), kTriangles.size()};
  PlySink sink(folder_, Shading::kSmooth);
  auto file = sink.open("a.ply", counts);
  ASSERT_TRUE(file.has_value());
  ASSERT_TRUE((*file)->add_vertices(kVertices).has_value());
  ASSERT_TRUE((*file)->add_triangles(kTriangles).has_value());
  ASSERT_TRUE((*file)->finish().has_value());
  EXPECT_EQ(std::filesystem::file_size(folder_ / "a.ply"), ply_bytes(counts, Shading::kSmooth));

  const auto model = scene::import_ply(folder_ / "a.ply", scene::ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes.size(), 1u);
  const scene::Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.positions.size(), kVertices.size());
  for (std::size_t i = 0; i < kVertices.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.positions[i][k] + static_cast<float>(mesh.origin[static_cast<Eigen::Index>(k)]),
                kVertices[i].position[k]);
      EXPECT_EQ(mesh.normals[i][k], kVertices[i].normal[k]);
      EXPECT_EQ(mesh.colours[i][k], kVertices[i].colour[k]);
    }
  }
  EXPECT_THAT(mesh.triangles, testing::ElementsAreArray(kTriangles));
}

TEST_F(PlyWriter, omits_normals_for_flat_shading) {
  const GeometryCounts counts{kVertices.size(), kTriangles.size()};
  PlySink sink(folder_, Shading::kFlat);
  auto file = sink.open("a.ply", counts);
  ASSERT_TRUE(file.has_value());
  ASSERT_TRUE((*file)->add_vertices(kVertices).has_value());
  ASSERT_TRUE((*file)->add_triangles(kTriangles).has_value());
  ASSERT_TRUE((*file)->finish().has_value());
  EXPECT_EQ(std::filesystem::file_size(folder_ / "a.ply"), ply_bytes(counts, Shading::kFlat));
  const auto model = scene::import_ply(folder_ / "a.ply", scene::ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_TRUE(model->meshes[0].normals.empty());
  EXPECT_EQ(model->meshes[0].colours[1][0], 255);
}

TEST_F(PlyWriter, never_overwrites_a_file) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a.ply", "mine").has_value());
  const auto file = PlySink(folder_, Shading::kSmooth).open("a.ply", {});
  ASSERT_FALSE(file.has_value());
  EXPECT_THAT(file.error().message(), testing::HasSubstr("a.ply"));
}

TEST_F(PlyWriter, reports_a_missing_folder) {
  const auto absent = PlySink(folder_ / "absent", Shading::kSmooth).open("a.ply", {});
  ASSERT_FALSE(absent.has_value());
  EXPECT_EQ(absent.error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama::generator
