// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>

#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// Writes LAS 1.2 with points of the formats 0 and 2.
struct LasBuilder {
  std::uint8_t format = 2;
  std::uint32_t announced = 0xffffffff;  ///< The true number by default.
  std::string points;
  std::uint32_t count = 0;

  template <typename Number>
  static void put(std::string* bytes, std::size_t at, Number value) {
    std::memcpy(bytes->data() + at, &value, sizeof value);
  }
  LasBuilder& add(std::array<std::int32_t, 3> place, std::uint16_t intensity, std::array<std::uint16_t, 3> colour,
                  std::uint8_t kind = 0) {
    std::string point(format == 2 ? 26 : 20, '\0');
    put(&point, 0, place);
    put(&point, 12, intensity);
    put(&point, 15, kind);
    if (format == 2) put(&point, 20, colour);
    points += point;
    ++count;
    return *this;
  }
  [[nodiscard]] std::string file() const {
    std::string header(227, '\0');
    header.replace(0, 4, "LASF");
    put(&header, 24, std::uint8_t{1});
    put(&header, 25, std::uint8_t{2});
    put(&header, 94, std::uint16_t{227});
    put(&header, 96, std::uint32_t{227});
    put(&header, 104, format);
    put(&header, 105, static_cast<std::uint16_t>((format & 63) == 2 ? 26 : 20));
    put(&header, 107, announced == 0xffffffff ? count : announced);
    put(&header, 131, std::array<double, 3>{0.01, 0.01, 0.01});
    put(&header, 155, std::array<double, 3>{500'000.0, 4'000'000.0, 100.0});
    return header + points;
  }
};

Result<Model> import(const std::string& bytes, const ImportLimits& limits = {}) {
  const MemoryFile file(bytes);
  Result<Model> model = import_las(file.path(), limits);
  if (model) {
    EXPECT_EQ(broken_promise(*model), "");
  }
  return model;
}

std::string complaint(const std::string& bytes, const ImportLimits& limits = {}) {
  const Result<Model> model = import(bytes, limits);
  if (model) return "";
  EXPECT_EQ(model.error().code(), ErrorCode::kBadData);
  return model.error().message();
}

LasBuilder four_points() {
  LasBuilder las;
  las.add({0, 0, 0}, 10, {65535, 0, 0}).add({100, 0, 0}, 20, {0, 32768, 0});
  las.add({0, 100, 0}, 30, {0, 0, 257}).add({0, 0, 100}, 40, {0, 0, 0});
  return las;
}

TEST(LasImport, points_become_squares_with_their_colours_and_z_points_up) {
  const auto model = import(four_points().file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 8u);
  EXPECT_EQ(mesh.colours[0], (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
  EXPECT_EQ(mesh.colours[4][1], 128);
  EXPECT_EQ(mesh.colours[8][2], 1);
  // The middle of a square is the middle of its diagonal.
  const auto middle = [&](std::size_t point) -> Eigen::Vector3d {
    const auto& a = mesh.positions[4 * point];
    const auto& b = mesh.positions[4 * point + 2];
    return mesh.origin + 0.5 * Eigen::Vector3f(a[0] + b[0], a[1] + b[1], a[2] + b[2]).cast<double>();
  };
  EXPECT_TRUE(middle(0).isApprox(Eigen::Vector3d(500'000.0, 100.0, -4'000'000.0), 1e-12));
  EXPECT_NEAR((middle(3) - middle(0)).y(), 1.0, 1e-4) << "the file's z";
  EXPECT_NEAR((middle(2) - middle(0)).z(), -1.0, 1e-4) << "the file's y";
}

TEST(LasImport, colours_that_were_written_as_bytes_are_not_black) {
  LasBuilder las;
  las.add({0, 0, 0}, 0, {200, 100, 50}).add({1, 0, 0}, 0, {255, 0, 0});
  const auto model = import(las.file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(model->meshes[0].colours[0], (std::array<std::uint8_t, 4>{200, 100, 50, 255}));
}

TEST(LasImport, without_colours_the_intensity_is_shown_with_a_note) {
  LasBuilder las;
  las.format = 0;
  for (int i = 0; i < 100; ++i) las.add({i, 0, 0}, i == 99 ? 60'000 : static_cast<std::uint16_t>(10 * i), {});
  const auto model = import(las.file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_THAT(model->notes, Contains(HasSubstr("by their intensity")));
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.colours[0][0], 0);
  EXPECT_NEAR(mesh.colours[std::size_t{4} * 49][0], 128, 4) << "one glint does not darken the rest";
  EXPECT_EQ(mesh.colours[std::size_t{4} * 99][0], 255);
}

TEST(LasImport, noise_and_withheld_points_are_left_out_and_counted) {
  LasBuilder las = four_points();
  las.add({9999, 0, 0}, 0, {}, 7).add({0, 9999, 0}, 0, {}, 0x80 | 2);
  const auto model = import(las.file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_EQ(model->meshes[0].triangles.size(), 8u);
  EXPECT_THAT(model->notes, Contains(HasSubstr("2 points are marked as noise")));
}

TEST(LasImport, damaged_files_are_refused_with_the_reason) {
  const std::string whole = four_points().file();
  for (std::size_t size = 0; size < whole.size(); ++size) ASSERT_NE(complaint(whole.substr(0, size)), "") << size;
  LasBuilder many = four_points();
  many.announced = 4'000'000'000;
  EXPECT_THAT(complaint(many.file()), HasSubstr("announces 4000000000 points, but the file holds 4"));
  LasBuilder odd = four_points();
  odd.format = 11;
  EXPECT_THAT(complaint(odd.file()), HasSubstr("format 11"));
  LasBuilder none;
  EXPECT_THAT(complaint(none.file()), HasSubstr("neither triangles nor points"));
  LasBuilder laz = four_points();
  laz.format = 0x82;
  EXPECT_THAT(complaint(laz.file()), HasSubstr("LAZ"));
  EXPECT_THAT(complaint(whole, {.memory_bytes = 100}), HasSubstr("more than the 0 MiB"));
}

TEST(LasImport, files_of_pdal_and_potree_are_read) {
  CYCLORAMA_SHARED_DATA(folder, "scans/las");
  const std::vector<std::pair<const char*, std::size_t>> files = {
      {"1.2-with-color.las", 1065}, {"test1_4.las", 1000}, {"extrabytes.las", 1065}, {"lion_takanawa/las/r.las", 0}};
  for (const auto& [name, points] : files) {
    const Result<Model> model = import_las(folder / name, {});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    EXPECT_EQ(broken_promise(*model), "") << name;
    EXPECT_TRUE(points == 0 || model->meshes[0].triangles.size() == 2 * points) << name;
    const Eigen::Vector3d size = bounds_of(*model).sizes();
    EXPECT_GT(size.maxCoeff(), 0.1) << name;
  }
  EXPECT_THAT(import_las(folder / "no-points.las", {}).error().message(), HasSubstr("nor points"));
  EXPECT_THAT(import_las(folder / "garbage_nVariableLength.las", {}).error().message(), HasSubstr("cut short"));
  EXPECT_THAT(import_las(folder / "lone-star.copc.laz", {}).error().message(), HasSubstr("COPC"));
}

}  // namespace
}  // namespace cyclorama::scene
