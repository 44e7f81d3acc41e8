// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/e57_xml.h"
#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/e57_builder.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Result<Model> import(const std::string& bytes, const ImportLimits& limits = {}) {
  const MemoryFile file(bytes);
  Result<Model> model = import_e57(file.path(), limits);
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

std::string floats(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) put_number(&bytes, value);
  return bytes;
}

Eigen::Vector3d middle_of(const Mesh& mesh, std::size_t point) {
  const auto& a = mesh.positions[4 * point];
  const auto& b = mesh.positions[4 * point + 2];
  return mesh.origin + 0.5 * Eigen::Vector3f(a[0] + b[0], a[1] + b[1], a[2] + b[2]).cast<double>();
}

const std::string kPlaces =
    "<cartesianX type='Float' precision='single'/><cartesianY type='Float' precision='single'/>"
    "<cartesianZ type='Float' precision='single'/>";

/// Two points, in two packets, with packed colours of 4 bits.
E57Builder two_points() {
  E57Builder built;
  built.count = 2;
  built.prototype = kPlaces +
                    "<colorRed type='Integer' minimum='0' maximum='15'/><colorGreen type='Integer' minimum='0' "
                    "maximum='15'/><colorBlue type='Integer' minimum='7' maximum='7'/>";
  built.add_packet({floats({1.0f}), floats({2.0f}), floats({3.0f}), "\xf0", "\x0f", ""});
  built.add_packet({floats({4.0f}), floats({5.0f}), floats({6.0f}), "", "", ""});
  return built;
}

TEST(E57Import, points_come_in_packets_with_packed_colours) {
  const auto model = import(two_points().file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_TRUE(middle_of(mesh, 0).isApprox(Eigen::Vector3d(1, 3, -2), 1e-6));
  EXPECT_TRUE(middle_of(mesh, 1).isApprox(Eigen::Vector3d(4, 6, -5), 1e-6));
  EXPECT_EQ(mesh.colours[0][0], 0);
  EXPECT_EQ(mesh.colours[4][0], 255);
  EXPECT_EQ(mesh.colours[0][1], 255);
}

TEST(E57Import, a_pose_places_the_scan) {
  E57Builder built = two_points();
  // A quarter turn about z, then a step along x.
  built.scan =
      "<pose type='Structure'><rotation type='Structure'><w type='Float'>0.7071067811865476</w><x type='Float'/>"
      "<y type='Float'/><z type='Float'>0.7071067811865476</z></rotation><translation type='Structure'>"
      "<x type='Float'>10</x><y type='Float'/><z type='Float'/></translation></pose>";
  const auto model = import(built.file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_TRUE(middle_of(model->meshes[0], 0).isApprox(Eigen::Vector3d(8, 3, -1), 1e-6));
}

TEST(E57Import, scaled_spherical_points_with_intensity_are_read_and_invalid_ones_are_not) {
  E57Builder built;
  built.count = 2;
  built.prototype =
      "<sphericalRange type='ScaledInteger' minimum='0' maximum='65535' scale='0.001' offset='1'/>"
      "<sphericalAzimuth type='Float'/><sphericalElevation type='Float'/>"
      "<intensity type='Integer' minimum='0' maximum='255'/>"
      "<sphericalInvalidState type='Integer' minimum='0' maximum='2'/>";
  std::string zeros;
  put_number(&zeros, 0.0);
  put_number(&zeros, 0.0);
  built.add_packet({std::string("\xe8\x03\x00\x00", 4), zeros, zeros, "\xff\x80", "\x04"});
  const auto model = import(built.file());
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes[0].triangles.size(), 2u);
  EXPECT_TRUE(middle_of(model->meshes[0], 0).isApprox(Eigen::Vector3d(2, 0, 0), 1e-6));
  EXPECT_EQ(model->meshes[0].colours[0][0], 255);
  EXPECT_THAT(model->notes, Contains(HasSubstr("1 points are invalid")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("by their intensity")));
}

TEST(E57Import, every_damaged_byte_is_noticed_by_its_page) {
  const std::string whole = two_points().file();
  for (std::size_t i = kE57HeaderBytes; i < whole.size(); i += 7) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    ASSERT_THAT(complaint(damaged), HasSubstr("checksum")) << i;
  }
  for (std::size_t size = 0; size < whole.size(); size += 13) ASSERT_NE(complaint(whole.substr(0, size)), "") << size;
}

TEST(E57Import, counts_that_the_file_cannot_hold_are_refused) {
  E57Builder many = two_points();
  many.count = 4'000'000'000;
  EXPECT_THAT(complaint(many.file()), HasSubstr("more than the file holds"));
  E57Builder few = two_points();
  few.count = 3;
  EXPECT_THAT(complaint(few.file()), HasSubstr("scan 1 of 1: its packets end after 2 of 3 points"));
  E57Builder constant;
  constant.count = 1'000'000'000;
  for (const char* const name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    constant.prototype += std::string("<") + name + " type='Integer' minimum='1' maximum='1'/>";
  }
  EXPECT_THAT(complaint(constant.file()), HasSubstr("of 0 bits are more than the file holds"));
  EXPECT_THAT(complaint(two_points().file(), {.memory_bytes = 100}), HasSubstr("more than the 0 MiB"));
}

TEST(E57Import, packets_that_contradict_their_prototype_are_refused) {
  E57Builder built = two_points();
  built.prototype = kPlaces;
  EXPECT_THAT(complaint(built.file()), HasSubstr("6 streams for 3 fields"));
  E57Builder odd = two_points();
  odd.packets[0] = '\7';
  EXPECT_THAT(complaint(odd.file()), HasSubstr("type 7"));
  E57Builder lost = two_points();
  lost.prototype = "<cartesianX type='Float'/>";
  EXPECT_THAT(complaint(lost.file()), HasSubstr("neither x, y and z"));
}

TEST(E57Xml, elements_attributes_texts_and_entities_are_read) {
  const auto root = parse_e57_xml("<?xml version='1.0'?><!-- a --><r a='1&lt;2'><b/>x<![CDATA[<y>]]>&amp;</r>");
  ASSERT_TRUE(root.has_value()) << root.error().message();
  EXPECT_EQ(root->attribute("a"), "1<2");
  EXPECT_EQ(root->text, "x<y>&");
  EXPECT_NE(root->child("b"), nullptr);
  EXPECT_EQ(root->child("c"), nullptr);
}

TEST(E57Xml, anything_else_is_an_error_with_its_byte) {
  for (const char* const text :
       {"", "x", "<a>", "<a></b>", "<a b></a>", "<a b=c/>", "<a b='1", "<!DOCTYPE a><a/>", "<a><![CDATA[</a>"}) {
    const auto root = parse_e57_xml(text);
    ASSERT_FALSE(root.has_value()) << text;
    EXPECT_THAT(root.error().message(), HasSubstr("at byte"));
  }
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_FALSE(parse_e57_xml(deep).has_value());
  for (int i = 0; i < 100'000; ++i) deep += "</a>";
  const auto root = parse_e57_xml(deep);
  ASSERT_FALSE(root.has_value());
  EXPECT_THAT(root.error().message(), HasSubstr("nested too deeply"));
}

TEST(E57Import, files_of_libe57format_are_read_or_refused) {
  CYCLORAMA_SHARED_DATA(folder, "scans/e57");
  for (const auto& [name, points, size] : {std::tuple{"ColouredCubeFloat.e57", 7680, 1.0},
                                           {"ColouredCubeDouble.e57", 7680, 1.0},
                                           {"bunnyDouble.e57", 30571, 0.15}}) {
    const Result<Model> model = import_e57(folder / name, {});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    EXPECT_EQ(broken_promise(*model), "") << name;
    EXPECT_EQ(model->meshes[0].triangles.size(), static_cast<std::size_t>(2 * points)) << name;
    EXPECT_NEAR(bounds_of(*model).sizes().maxCoeff(), size, 0.2 * size) << name;
  }
  for (const char* const name : {"InvalidCVHeader.e57", "ZeroPointsInvalid.e57", "empty.e57"}) {
    EXPECT_FALSE(import_e57(folder / name, {}).has_value()) << name;
  }
}

}  // namespace
}  // namespace cyclorama::scene
