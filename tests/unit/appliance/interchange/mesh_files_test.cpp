// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mesh_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "tests/data_sets/generated_warps.h"

namespace cyclorama::interchange {
namespace {

using ::testing::HasSubstr;

void expect_near(const WarpNet& a, const WarpNet& b) {
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_NEAR(a.nodes[i].x, b.nodes[i].x, 6e-8) << i;
    EXPECT_NEAR(a.nodes[i].y, b.nodes[i].y, 6e-8) << i;
    EXPECT_NEAR(a.nodes[i].u, b.nodes[i].u, 6e-8) << i;
    EXPECT_NEAR(a.nodes[i].v, b.nodes[i].v, 6e-8) << i;
    EXPECT_NEAR(a.nodes[i].light, b.nodes[i].light, 6e-8) << i;
  }
}

TEST(Bourke, survives_a_round_trip_to_seven_decimals_and_is_rewritten_identically) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    GeneratedWarps made(seed);
    WarpNet net = made.grid();
    net.closed = seed % 2 == 0;
    const double aspect = made.number(0.5, 2.5);
    const auto text = print_bourke(net, aspect);
    ASSERT_TRUE(text.has_value()) << text.error().message();
    const auto back = parse_bourke(*text, aspect);
    ASSERT_TRUE(back.has_value()) << back.error().message();
    expect_near(*back, net);
    EXPECT_EQ(back->closed, net.closed);
    EXPECT_EQ(*print_bourke(*back, aspect), *text) << seed;
  }
}

TEST(Bourke, reads_a_mesh_as_its_author_writes_it) {
  const auto net = parse_bourke("2\n2 2\r\n-1.6 -1 0 0 1\n1.6 -1 1 0 1\n  -1.6 1 0 1\t0.5\n1.6 1 1 1 -1\n", 1.6);
  ASSERT_TRUE(net.has_value()) << net.error().message();
  EXPECT_EQ(net->nodes[0], (WarpNode{0.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(net->nodes[2], (WarpNode{0.0, 1.0, 0.0, 1.0, 0.5}));
  EXPECT_TRUE(net->drawn().size() == 0) << "both triangles have the node that is not drawn";
}

TEST(Bourke, names_the_line_of_every_mistake) {
  const auto refusal = [](std::string_view text) {
    const auto net = parse_bourke(text, 1.0);
    return net ? "" : net.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("line 1: no mesh type"));
  EXPECT_THAT(refusal("3\n2 2\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("2\n2\n"), HasSubstr("line 2: no columns and rows"));
  EXPECT_THAT(refusal("2\n1 2\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal("2\n4000000 4000000\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n0 0 0 0\n"), HasSubstr("line 4: 4 numbers"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n0 0 nan 0 1\n"), HasSubstr("line 4: 'nan'"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n"), HasSubstr("after line 3: 1 nodes"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n0 0 0 0 1\n0 0 0 0 1\n0 0 0 0 1\n0 0 0 0 1\n"), HasSubstr("line 7"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n0 0 9e9 0 1\n0 0 0 0 1\n0 0 0 0 1\n"), HasSubstr("mesh node 2"));
  EXPECT_THAT(refusal("2\n2 2\n0 0 0 0 1\n0 0 0 0 7\n0 0 0 0 1\n0 0 0 0 1\n"), HasSubstr("intensity is 7"));
  EXPECT_EQ(parse_bourke("", 0.0).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(print_bourke(GeneratedWarps(1).triangles(), 1.0).error().code(), ErrorCode::kInvalidArgument);
}

TEST(WarpObj, survives_a_round_trip_to_seven_decimals_and_is_rewritten_identically) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const WarpNet net = GeneratedWarps(seed).triangles();
    const auto text = print_warp_obj(net);
    ASSERT_TRUE(text.has_value()) << text.error().message();
    const auto back = parse_warp_obj(*text);
    ASSERT_TRUE(back.has_value()) << back.error().message();
    expect_near(*back, net);
    EXPECT_EQ(*print_warp_obj(*back), *text) << seed;
  }
}

TEST(WarpObj, reads_polygons_relative_indices_and_shared_vertices) {
  const auto net = parse_warp_obj(
      "# made elsewhere\nmtllib x.mtl\no screen\nv -1 -1\nv 1 -1 0\nv 1 1 0.0\nv -1 1 0\nvn 0 0 1\n"
      "vt 0 0\nvt 1 0\nvt 1 1 0\nvt 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nf -4//1 -2/-2 -1/1\n");
  ASSERT_TRUE(net.has_value()) << net.error().message();
  ASSERT_EQ(net->triangles.size(), 3U);
  ASSERT_EQ(net->nodes.size(), 5U) << "the last face gives vertex 4 another texture vertex";
  const WarpNode& last = net->nodes[net->triangles[2][2]];
  EXPECT_EQ(last, (WarpNode{0.0, 1.0, 0.0, 0.0, 1.0}));
}

TEST(WarpObj, names_the_line_of_every_mistake) {
  const auto refusal = [](std::string_view text) {
    const auto net = parse_warp_obj(text);
    return net ? "" : net.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("end: there is no vertex"));
  EXPECT_THAT(refusal("v 0 0 1\n"), HasSubstr("line 1: the mesh is not flat"));
  EXPECT_THAT(refusal("v 0\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("v 0 x 0\n"), HasSubstr("line 1: 'x'"));
  EXPECT_THAT(refusal("v 0 0 0\nvt 0 0\nf 1 1 2\n"), HasSubstr("line 3: a face names '2' of 1"));
  EXPECT_THAT(refusal("v 0 0 0\nvt 0 0\nf 1 1 0\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal("v 0 0 0\nvt 0 0\nf 1 1\n"), HasSubstr("line 3: a face of 2 corners"));
  EXPECT_THAT(refusal("v 0 0 0\nvt 0 0\ncurv 1\n"), HasSubstr("line 3: 'curv'"));
  EXPECT_THAT(refusal("v 0 0 0\nvt 0 0\n"), HasSubstr("no faces"));
}

TEST(Domeprojection, reads_nodes_in_any_order_from_the_upper_left_corner) {
  const auto net = parse_domeprojection(
      "x;y;u;v;column;row\n0;1;0.1;0.9;0;1\n1;1;0.8;0.9;1;1\r\n0;0;0.1;0.2;0;0\n1;0;0.8;0.2;1;0\n");
  ASSERT_TRUE(net.has_value()) << net.error().message();
  EXPECT_EQ(net->columns, 2);
  EXPECT_EQ(net->nodes[1], (WarpNode{1.0, 1.0, 0.8, 0.8, 1.0}));
  EXPECT_EQ(net->nodes[2], (WarpNode{0.0, 0.0, 0.1, 1.0 - 0.9, 1.0}));
}

TEST(Domeprojection, names_the_line_of_every_mistake) {
  const auto refusal = [](std::string_view text) {
    const auto net = parse_domeprojection(text);
    return net ? "" : net.error().message();
  };
  EXPECT_THAT(refusal("x;y;u;v;column;row\n0;0;0;0;0\n"), HasSubstr("line 2: 5 fields"));
  EXPECT_THAT(refusal("0;0;0;0;0;0\nx;0;0;0;0;1\n"), HasSubstr("line 2: 'x'"));
  EXPECT_THAT(refusal("0,5;0;0;0;0;0\n0,5;0;0;0;0;0\n"), HasSubstr("line 2: '0,5'"));
  EXPECT_THAT(refusal("0;0;0;0;0;-1\n"), HasSubstr("line 1: '-1'"));
  EXPECT_THAT(refusal("0;0;0;0;0;0\n0;0;0;0;1;1\n0;0;0;0;1;1\n0;0;0;0;0;1\n"), HasSubstr("line 3: column 1 of row 1"));
  EXPECT_THAT(refusal("0;0;0;0;0;0\n0;0;0;0;1;1\n0;0;0;0;0;1\n"), HasSubstr("column 1 of row 0 is missing"));
  EXPECT_THAT(refusal("0;0;0;0;60000;60000\n"), HasSubstr("end: 1 nodes"));
  EXPECT_THAT(refusal(""), HasSubstr("end: 0 nodes"));
}

TEST(SimCad, offsets_move_nodes_right_and_down) {
  const auto net = parse_simcad(
      "<GeometryFile><GeometryDefinition><X-FlatParameters range=\"2560\">0 256 0 0</X-FlatParameters>"
      "<Y-FlatParameters range=\"1\">0 0.25\n0 0</Y-FlatParameters></GeometryDefinition></GeometryFile>");
  ASSERT_TRUE(net.has_value()) << net.error().message();
  EXPECT_EQ(net->columns, 2);
  EXPECT_EQ(net->nodes[0], (WarpNode{0.0, 1.0, 0.0, 1.0, 1.0})) << "the upper left corner comes first";
  EXPECT_EQ(net->nodes[1], (WarpNode{1.1, 0.75, 1.0, 1.0, 1.0}));
}

TEST(SimCad, names_the_line_of_every_mistake) {
  const auto refusal = [](std::string_view x, std::string_view y) {
    const auto net =
        parse_simcad(fmt::format("<GeometryFile>\n<GeometryDefinition>\n<X-FlatParameters {}"
                                 "</X-FlatParameters>\n<Y-FlatParameters {}</Y-FlatParameters>\n"
                                 "</GeometryDefinition></GeometryFile>",
                                 x, y));
    return net ? "" : net.error().message();
  };
  EXPECT_EQ(refusal("range=\"1\">0 0 0 0", "range=\"1\">0 0 0 0"), "");
  EXPECT_THAT(refusal(">0 0 0 0", "range=\"1\">0 0 0 0"), HasSubstr("SimCAD, line 3, <X-FlatParameters>"));
  EXPECT_THAT(refusal("range=\"1\">0 0 0 0", "range=\"0\">0 0 0 0"), HasSubstr("line 4"));
  EXPECT_THAT(refusal("range=\"1\">0 0 q 0", "range=\"1\">0 0 0 0"), HasSubstr("line 3, <X-FlatParameters>: 'q'"));
  EXPECT_THAT(refusal("range=\"1\">0 0 0", "range=\"1\">0 0 0 0"),
              HasSubstr("line 2, <GeometryDefinition>: 3 offsets"));
  EXPECT_THAT(parse_simcad("<Geometry/>").error().message(), HasSubstr("line 1"));
  EXPECT_THAT(parse_simcad("no xml").error().message(), HasSubstr("this is no XML"));
}

TEST(MeshFiles, errors_name_the_file) {
  const auto path = std::filesystem::temp_directory_path() / ("mesh_test_" + std::to_string(::getpid()) + ".data");
  const WarpNet net = GeneratedWarps(3).grid();
  ASSERT_TRUE(write_bourke(path, net, 1.5).has_value());
  EXPECT_TRUE(read_bourke(path, 1.5).has_value());
  ASSERT_TRUE(write_warp_obj(path, net).has_value());
  EXPECT_TRUE(read_warp_obj(path).has_value());
  for (const auto& refused : {read_bourke(path, 1.5), read_domeprojection(path), read_simcad(path)}) {
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message(), HasSubstr(path.string()));
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cyclorama::interchange
