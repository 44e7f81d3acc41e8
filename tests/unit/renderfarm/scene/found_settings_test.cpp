// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderfarm/scene/area.h"
#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/back_faces.h"
#include "renderfarm/scene/found_frame.h"
#include "renderfarm/scene/found_light.h"

namespace cyclorama::scene {
namespace {

using Box = Eigen::AlignedBox3d;

/// Twelve triangles that face out of the box, or into it.
Mesh box_mesh(const Box& box, bool faces_in) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3f p = box.corner(static_cast<Box::CornerType>(i)).cast<float>();
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  const std::array<std::array<std::uint32_t, 4>, 6> sides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({s[0], s[faces_in ? 2 : 1], s[faces_in ? 1 : 2]});
    mesh.triangles.push_back({s[0], s[faces_in ? 3 : 2], s[faces_in ? 2 : 3]});
  }
  return mesh;
}

Model model_of(std::vector<Mesh> meshes) {
  Model model;
  model.materials.emplace_back();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    model.instances.push_back({static_cast<int>(i), Eigen::Affine3d::Identity()});
  }
  model.meshes = std::move(meshes);
  return model;
}

Box box(const Eigen::Vector3d& min, const Eigen::Vector3d& max) { return {min, max}; }

FoundSettings settings_of(const Model& model) {
  const FoundSettings found = find_settings(model, bounds_of(model), std::nullopt);
  EXPECT_GE(found.walkable.size(), 3u);
  EXPECT_TRUE(is_inside(found.walkable, {found.eye.x(), found.eye.z()}));
  EXPECT_TRUE(found.eye.allFinite());
  return found;
}

TEST(FindSettings, the_eye_is_inside_a_room_and_looks_along_it) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({100, -3, 200}, {106, 1, 220}), true)}));
  EXPECT_EQ(found.kind, SceneKind::kRoom);
  EXPECT_NEAR(found.eye.y(), -3.0 + 1.6, 0.05);
  EXPECT_NEAR(std::abs(std::cos(found.heading_rad)), 1.0, 0.1) << "the room is long along z";
  for (const Eigen::Vector2d& corner : found.walkable) {
    EXPECT_TRUE(corner.x() > 100.1 && corner.x() < 105.9 && corner.y() > 200.1 && corner.y() < 219.9);
  }
}

TEST(FindSettings, a_room_is_recognised_with_thin_walls_of_either_side_and_with_thick_ones) {
  const Mesh inner = box_mesh(box({0, 0, 0}, {8, 3, 6}), true);
  const Mesh outer = box_mesh(box({-0.3, -0.3, -0.3}, {8.3, 3.3, 6.3}), false);
  EXPECT_EQ(settings_of(model_of({inner})).kind, SceneKind::kRoom);
  EXPECT_EQ(settings_of(model_of({inner, outer})).kind, SceneKind::kRoom);
}

TEST(FindSettings, the_eye_is_never_inside_a_statue) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {4, 9, 4}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_GT(found.eye.z(), 4.0);
}

TEST(FindSettings, the_eye_is_neither_on_nor_in_the_furniture) {
  const Mesh room = box_mesh(box({0, 0, 0}, {6, 3, 6}), true);
  const Mesh block = box_mesh(box({0, 0, 0}, {3, 2.9, 6}), false);
  const FoundSettings found = settings_of(model_of({room, block}));
  EXPECT_EQ(found.kind, SceneKind::kRoom);
  EXPECT_GT(found.eye.x(), 3.2);
  for (const Eigen::Vector2d& corner : found.walkable) EXPECT_GT(corner.x(), 2.95);
}

TEST(FindSettings, open_ground_is_recognised_as_a_site) {
  Model model = model_of(
      {box_mesh(box({-20, -0.2, -20}, {20, 0, 20}), false), box_mesh(box({-15, 0, -15}, {-10, 4, -10}), false)});
  const FoundSettings found = settings_of(model);
  EXPECT_EQ(found.kind, SceneKind::kSite);
  EXPECT_NEAR(found.eye.y(), 1.6, 0.05);
}

TEST(FindSettings, the_top_of_a_large_object_is_not_a_site) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {6, 6, 6}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_GT(found.eye.z(), 6.0);
  const FoundSettings plain = settings_of(model_of({box_mesh(box({0, 0, 0}, {20, 3, 20}), false)}));
  EXPECT_EQ(plain.kind, SceneKind::kSite) << "nothing rises from a plain";
}

TEST(FindSettings, nobody_stands_on_a_plinth_or_a_table_when_there_is_floor) {
  const Mesh room = box_mesh(box({0, 0, 0}, {12, 5, 12}), true);
  const Mesh plinth = box_mesh(box({4.5, 0, 4.5}, {7.5, 1, 7.5}), false);
  const FoundSettings found = settings_of(model_of({room, plinth}));
  EXPECT_EQ(found.kind, SceneKind::kRoom);
  EXPECT_NEAR(found.eye.y(), 1.6, 0.1);
}

TEST(FindSettings, an_open_site_is_entered_where_there_is_something_to_see) {
  const Mesh ground = box_mesh(box({-40, -0.2, -40}, {40, 0, 40}), false);
  std::vector<Mesh> meshes = {ground};
  for (const double x : {-2.0, 4.0, 9.0}) meshes.push_back(box_mesh(box({x, 0, -3}, {x + 3, 6, 3}), false));
  const FoundSettings found = settings_of(model_of(std::move(meshes)));
  EXPECT_EQ(found.kind, SceneKind::kSite);
  EXPECT_NEAR(found.eye.y(), 1.6, 0.1);
  EXPECT_LT(std::hypot(found.eye.x() - 4.0, found.eye.z()), 30.0) << "not at the corner of its box";
  const Eigen::Vector3d towards = (Eigen::Vector3d(4.0, found.eye.y(), 0.0) - found.eye).normalized();
  const Eigen::Vector3d view(std::sin(found.heading_rad), 0.0, -std::cos(found.heading_rad));
  EXPECT_GT(view.dot(towards), 0.4) << "looks at what stands there";
}

TEST(FindSettings, a_small_room_without_a_ceiling_is_entered_and_open_to_the_sky) {
  Mesh court = box_mesh(box({0, 0, 0}, {5, 3, 4}), true);
  std::erase_if(court.triangles, [&](const auto& t) {
    return court.positions[t[0]][1] > 2.0f && court.positions[t[1]][1] > 2.0f && court.positions[t[2]][1] > 2.0f;
  });
  const FoundSettings found = settings_of(model_of({court}));
  EXPECT_EQ(found.kind, SceneKind::kSite);
  EXPECT_TRUE(found.eye.x() > 0.0 && found.eye.x() < 5.0 && found.eye.z() > 0.0 && found.eye.z() < 4.0);
}

TEST(FindSettings, a_flat_thing_is_seen_from_its_front) {
  // Two sheets of 2 m by 1 m, open at the back.
  const auto sheet = [](bool along_x, bool turned) {
    Mesh mesh;
    for (const auto& [across, up] :
         {std::pair{0.0f, 0.0f}, std::pair{2.0f, 0.0f}, std::pair{2.0f, 1.0f}, std::pair{0.0f, 1.0f}}) {
      mesh.positions.push_back(along_x ? std::array{across, up, 0.0f} : std::array{0.0f, up, across});
    }
    // As listed, the first of them faces +z and the second -x.
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (turned) mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    return mesh;
  };
  const auto eye_of = [&](bool along_x, bool turned) { return settings_of(model_of({sheet(along_x, turned)})).eye; };
  EXPECT_GT(eye_of(true, false).z(), 0.5);
  EXPECT_LT(eye_of(true, true).z(), -0.5);
  EXPECT_LT(eye_of(false, false).x(), -0.5);
  EXPECT_GT(eye_of(false, true).x(), 0.5);
}

TEST(FindSettings, the_inside_of_a_large_hollow_thing_is_no_room) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {300, 400, 300}), true)}));
  EXPECT_EQ(found.kind, SceneKind::kObject) << "no building has a ceiling at 400 m";
}

TEST(FindFrame, takes_the_unit_from_the_height_of_rooms) {
  for (const auto& [metres, unit_m] : {std::pair{1.0, 1.0}, std::pair{100.0, 0.01}, std::pair{1000.0, 0.001}}) {
    Model model = model_of({box_mesh(box({0, 0, 0}, metres * Eigen::Vector3d(8, 3, 6)), true)});
    const FoundFrame frame = find_frame(&model, StatedFrame::kNothing);
    EXPECT_EQ(frame.unit_m, unit_m);
    EXPECT_EQ(frame.notes.empty(), unit_m == 1.0);
    EXPECT_TRUE(model.instances[0].T_model_mesh.matrix().isIdentity()) << "the file is left as it is";
  }
  Model hall = model_of({box_mesh(box({0, 0, 0}, {80, 20, 40}), true)});
  const FoundFrame frame = find_frame(&hall, StatedFrame::kNothing);
  EXPECT_EQ(frame.unit_m, 1.0);
  EXPECT_EQ(frame.notes.size(), 1u) << "it may be a thing in millimetres";
}

TEST(FindFrame, keeps_an_object_of_unknown_unit_and_says_what_it_looks_like) {
  Model statue = model_of({box_mesh(box({0, 0, 0}, {600, 1800, 500}), false)});
  const FoundFrame frame = find_frame(&statue, StatedFrame::kNothing);
  EXPECT_EQ(frame.unit_m, 1.0);
  ASSERT_EQ(frame.notes.size(), 1u);
  EXPECT_NE(frame.notes[0].find("looks like millimetres"), std::string::npos);
}

TEST(FindFrame, stands_a_small_flat_thing_up_to_face_the_visitor) {
  const auto front_of = [](Model model) {
    const FoundFrame frame = find_frame(&model, StatedFrame::kNothing);
    return Eigen::Vector3d(frame.T_scene_file.linear() * Eigen::Vector3d::UnitY());
  };
  Model coin = model_of({box_mesh(box({0, 0, 0}, {0.03, 0.002, 0.03}), false)});
  EXPECT_TRUE(front_of(coin).isApprox(Eigen::Vector3d::UnitZ()));
  Model face_down = coin;
  face_down.meshes[0].triangles = {{0, 1, 5}, {0, 5, 4}};  // Only the lower side.
  EXPECT_TRUE(front_of(face_down).isApprox(-Eigen::Vector3d::UnitZ()));
  coin.viewpoints.emplace_back();
  EXPECT_TRUE(front_of(coin).isApprox(Eigen::Vector3d::UnitY())) << "the author's camera shows it as it lies";
  EXPECT_TRUE(front_of(model_of({box_mesh(box({0, 0, 0}, {20, 0.5, 20}), false)})).isApprox(Eigen::Vector3d::UnitY()))
      << "ground to walk on";
}

TEST(FindFrame, a_file_of_no_stated_axis_that_stands_on_z_is_turned) {
  const auto up_of = [](const Box& bounds, StatedFrame stated) {
    Model model = model_of({box_mesh(bounds, false)});
    return Eigen::Vector3d(find_frame(&model, stated).T_scene_file.linear() * Eigen::Vector3d::UnitZ());
  };
  const Box on_z = box({-1, -1, 0}, {1, 1, 3});
  EXPECT_TRUE(up_of(on_z, StatedFrame::kNothing).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(up_of(on_z, StatedFrame::kUp).isApprox(Eigen::Vector3d::UnitZ())) << "glTF prescribes y";
  EXPECT_TRUE(up_of(box({0, 0, 0}, {1, 1, 1}), StatedFrame::kNothing).isApprox(Eigen::Vector3d::UnitZ())) << "no sign";
  EXPECT_TRUE(up_of(box({-1, -1, -1}, {1, 1, 1}), StatedFrame::kNothing).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST(FindFrame, a_building_in_centimetres_is_no_hall_of_fifty_metres) {
  Model house = model_of({box_mesh(box({0, 0, 0}, {1500, 300, 1200}), true)});
  EXPECT_EQ(find_frame(&house, StatedFrame::kNothing).unit_m, 0.01);
  house = model_of({box_mesh(box({0, 0, 0}, {150, 30, 120}), true)});
  EXPECT_EQ(find_frame(&house, StatedFrame::kNothing).unit_m, 1.0) << "a hall, or something in decimetres";
}

TEST(FindFrame, a_room_in_centimetres_that_lacks_a_wall_is_recognised) {
  Mesh cornell = box_mesh(box({0, 0, 0}, {556, 549, 559}), true);
  std::erase_if(cornell.triangles, [&](const auto& t) {
    return cornell.positions[t[0]][2] < 1.0f && cornell.positions[t[1]][2] < 1.0f && cornell.positions[t[2]][2] < 1.0f;
  });
  Model model = model_of({cornell});
  EXPECT_EQ(find_frame(&model, StatedFrame::kNothing).unit_m, 0.01);
}

TEST(FindFrame, surveyors_files_are_in_metres) {
  Model tile = model_of({box_mesh(box({0, 0, 0}, {5200, 330, 4000}), false)});
  EXPECT_EQ(find_frame(&tile, StatedFrame::kUpAndMetres).unit_m, 1.0);
  EXPECT_EQ(find_frame(&tile, StatedFrame::kUp).unit_m, 0.001);
}

TEST(FindSettings, an_object_of_any_size_is_seen_whole_with_room_to_walk_around_it) {
  for (const double size : {1e-4, 0.01, 0.45, 2.0}) {
    const FoundSettings found =
        settings_of(model_of({box_mesh(box({0, 0, 0}, {0.8 * size, size, 0.6 * size}), false)}));
    EXPECT_EQ(found.kind, SceneKind::kObject);
    const double distance = found.eye.z() - 0.6 * size;
    EXPECT_GT(distance, 0.0);
    EXPECT_LT((size - found.eye.y()) / distance, 0.35);
    EXPECT_GT((0.0 - found.eye.y()) / distance, -0.55);
    EXPECT_FALSE(is_inside(found.walkable, {0.4 * size, 0.3 * size})) << "in the object";
    EXPECT_TRUE(is_inside(found.walkable, {0.4 * size + (found.eye.z() - 0.3 * size), 0.3 * size})) << "beside it";
    EXPECT_GT(found.eye_height_m, 0.0);
    EXPECT_GT(found.walking_scale, 0.0);
  }
}

TEST(FindSettings, the_walkable_area_goes_round_corners_and_keeps_a_distance_from_walls) {
  // An L-shaped room of 10 x 10 m, whose quarter beyond (5, 5) is a block.
  const Mesh room = box_mesh(box({0, 0, 0}, {10, 3, 10}), true);
  const Mesh block = box_mesh(box({5, 0, 5}, {10, 3, 10}), false);
  const FoundSettings found = settings_of(model_of({room, block}));
  EXPECT_TRUE(is_inside(found.walkable, {1.0, 9.0}));
  EXPECT_TRUE(is_inside(found.walkable, {9.0, 1.0}));
  EXPECT_FALSE(is_inside(found.walkable, {7.0, 7.0}));
  EXPECT_FALSE(is_inside(found.walkable, {0.1, 5.0}));
  EXPECT_NEAR(area_of(found.walkable), 61.0, 6.0);
  EXPECT_LT(found.walkable.size(), 20u);
}

TEST(FindSettings, a_given_eye_is_kept_and_can_walk) {
  const Model model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(1, 1.2, 1), Eigen::Vector3d(0.05, 1.6, 3), Eigen::Vector3d(3, 2.9, 3),
        Eigen::Vector3d(50, 1.6, 3), Eigen::Vector3d(3, 1.6, 3)}) {
    const FoundSettings found = find_settings(model, bounds_of(model), eye);
    EXPECT_EQ(found.eye, eye);
    EXPECT_TRUE(is_inside(found.walkable, {eye.x(), eye.z()})) << eye.transpose();
    EXPECT_GT(area_of(found.walkable), 0.5);
  }
  EXPECT_NEAR(find_settings(model, bounds_of(model), Eigen::Vector3d(1, 1.2, 1)).eye_height_m, 1.2, 0.05);
}

TEST(FindSettings, degenerate_geometry_gets_a_view) {
  Mesh flat = box_mesh(box({0, 0, 0}, {1, 1, 0}), false);
  settings_of(model_of({flat}));
  Mesh point;
  point.positions.assign(3, {1.0f, 2.0f, 3.0f});
  point.triangles.push_back({0, 1, 2});
  settings_of(model_of({point}));
  Mesh huge = box_mesh(box({-1e12, -1e12, -1e12}, {1e12, 1e12, 1e12}), true);
  settings_of(model_of({huge}));
}

TEST(FindSettings, the_inside_of_a_thin_shell_is_no_room) {
  // A tank 190 m long whose two sides lie in the same cells of the grid.
  const Mesh outer = box_mesh(box({0, 0, 0}, {190, 14, 20}), false);
  const FoundSettings found = settings_of(model_of({outer}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_FALSE(box({0, 0, 0}, {190, 14, 20}).contains(found.eye));
}

TEST(FindSettings, a_room_lower_than_a_few_cells_is_not_recognised_in_a_large_scene) {
  // A town 600 m wide, with a wide roof 6 m above the ground.
  const Mesh ground = box_mesh(box({-300, -1, -300}, {300, 0, 300}), false);
  const Mesh roof = box_mesh(box({-40, 6, -40}, {40, 7, 40}), false);
  const Mesh tower = box_mesh(box({60, 0, -10}, {80, 30, 10}), false);
  const FoundSettings found = settings_of(model_of({ground, roof, tower}));
  EXPECT_EQ(found.kind, SceneKind::kSite);
  EXPECT_NEAR(found.eye.y(), 1.6, 0.3) << "stands on the ground, although a cell is 6 m high";
}

TEST(FindSettings, the_top_of_a_globe_between_others_is_not_ground) {
  // The ground around its top is a ring, whose outline encloses more than the ring.
  std::vector<Mesh> steps;
  for (int i = 0; i < 12; ++i) {
    const double radius = std::sqrt(std::max(0.0, 9.0 - 0.25 * (i - 6) * (i - 6)));
    steps.push_back(box_mesh(box({-radius, 0.5 * i - 3.0, -radius}, {radius, 0.5 * i - 2.5, radius}), false));
  }
  EXPECT_EQ(settings_of(model_of(std::move(steps))).kind, SceneKind::kObject);
}

TEST(FindSettings, a_small_room_that_lacks_a_wall_is_looked_into) {
  Mesh cornell = box_mesh(box({0, 0, 0}, {5.5, 5.5, 5.6}), true);
  std::erase_if(cornell.triangles, [&](const auto& t) {
    return cornell.positions[t[0]][2] < 1.0f && cornell.positions[t[1]][2] < 1.0f && cornell.positions[t[2]][2] < 1.0f;
  });
  const FoundSettings found = settings_of(model_of({cornell, box_mesh(box({2.6, 0, 2.5}, {4.7, 3.3, 4.5}), false),
                                                    box_mesh(box({0.8, 0, 0.7}, {2.9, 1.6, 2.7}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_LT(found.eye.z(), -2.0);
  EXPECT_NEAR(std::cos(found.heading_rad), -1.0, 1e-6) << "looks along +z, into it";
}

TEST(FindSettings, an_empty_landscape_is_seen_from_above) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {2000, 4, 2000}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_GT(found.eye.y(), 200.0);
  const FoundSettings hills = settings_of(model_of(
      {box_mesh(box({0, 0, 0}, {5000, 4, 4000}), false), box_mesh(box({1000, 0, 1000}, {1800, 200, 1500}), false)}));
  EXPECT_EQ(hills.kind, SceneKind::kObject);
}

TEST(FindSettings, a_thing_that_lies_flat_is_seen_from_higher_up) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {1, 0.1, 1}), false)}));
  const double distance = found.eye.z() - 1.0;
  EXPECT_GT(found.eye.y(), 0.3);
  EXPECT_LT(found.eye.y() / distance, 0.55) << "its nearest edge is on the wall";
}

TEST(FindSettings, a_thin_thing_is_not_seen_from_its_edge) {
  // A sheet that is nearly along z, and open at its back.
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {0.3f, 0, 1}, {0.3f, 1, 1}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, 0, 1).cross(Eigen::Vector3d::UnitY()).normalized();
  const FoundSettings found = settings_of(model_of({sheet}));
  EXPECT_GT((found.eye - Eigen::Vector3d(0.15, 0.5, 0.5)).normalized().dot(normal), 0.8);
}

TEST(BackFaces, are_seen_from_inside_of_a_thing_and_not_from_inside_of_a_room) {
  const Box walls = box({0, 0, 0}, {2, 3, 4});
  const Eigen::Vector3d inside(0.7, 1.0, 3.0);
  EXPECT_EQ(back_face_share(model_of({box_mesh(walls, false)}), inside), 1.0);
  EXPECT_EQ(back_face_share(model_of({box_mesh(walls, true)}), inside), 0.0);
  EXPECT_EQ(back_face_share(model_of({box_mesh(walls, false)}), {0, 10, 0}), 0.0);
  Model mirrored = model_of({box_mesh(walls, true)});
  mirrored.instances[0].T_model_mesh.scale(Eigen::Vector3d(-1, 1, 1));
  EXPECT_EQ(back_face_share(mirrored, {-0.7, 1.0, 3.0}), 0.0);
}

TEST(LevelViewpoint, keeps_a_camera_whose_level_picture_shows_the_scene) {
  const Box thing = box({-1, 0, -1}, {1, 2, 1});
  for (const Eigen::Vector3d& eye : {Eigen::Vector3d(0, 1, 5), Eigen::Vector3d(4, 2.2, 4), Eigen::Vector3d(0, 1, 0)}) {
    const Viewpoint view{"camera", eye, (thing.center() - eye + Eigen::Vector3d(0, 0, -0.1)).normalized()};
    const Viewpoint level = level_viewpoint(view, thing);
    EXPECT_EQ(level.eye, eye);
    EXPECT_EQ(level.direction, view.direction);
  }
}

TEST(LevelViewpoint, goes_down_to_the_wall_s_view_on_the_side_of_a_camera_that_looks_down) {
  const Box thing = box({-371, -181, -140}, {371, 92, 128});
  const Eigen::Vector3d eye(1006, 766, 953);  // A sample model's camera.
  const Viewpoint level = level_viewpoint({"camera", eye, (thing.center() - eye).normalized()}, thing);
  EXPECT_GT(level.eye.x(), 371.0);
  EXPECT_GT(level.eye.z(), 128.0);
  EXPECT_EQ(level.direction.y(), 0.0);
  const double distance = std::hypot(level.eye.x(), level.eye.z());
  EXPECT_LT((92.0 - level.eye.y()) / distance, 0.3);
  EXPECT_GT((-181.0 - level.eye.y()) / distance, -0.5);
  // A camera straight above has no heading of its own.
  const Viewpoint above = level_viewpoint({"top", {0, 5000, 0}, -Eigen::Vector3d::UnitY()}, thing);
  EXPECT_TRUE(above.eye.allFinite());
  EXPECT_NEAR(above.direction.norm(), 1.0, 1e-9);
}

TEST(AddLight, gives_rooms_lamps_and_objects_a_sky) {
  Scene room;
  room.model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  room.bounds = bounds_of(room.model);
  const FoundSettings in_room = find_settings(room.model, room.bounds, std::nullopt);
  add_light(in_room, &room);
  EXPECT_GT(room.eye_lamp.x(), 0.0f);
  ASSERT_EQ(room.model.lights.size(), 1u);
  EXPECT_TRUE(room.bounds.contains(room.model.lights[0].position));
  for (const double height : {2.2, 3.0, 12.0}) {
    Scene hall;
    hall.model = model_of({box_mesh(box({0, 0, 0}, {20, height, 20}), true)});
    hall.bounds = bounds_of(hall.model);
    add_light(find_settings(hall.model, hall.bounds, std::nullopt), &hall);
    ASSERT_EQ(hall.model.lights.size(), 1u);
    const Light& lamp = hall.model.lights[0];
    const double to_ceiling = height - lamp.position.y();
    EXPECT_GT(lamp.position.y(), 0.5) << height;
    EXPECT_LT(lamp.intensity.x() / (to_ceiling * to_ceiling), 4.5) << "burns the ceiling out at " << height << " m";
  }
  Scene object;
  object.model = model_of({box_mesh(box({0, 0, 0}, {1, 1, 1}), false)});
  object.bounds = bounds_of(object.model);
  add_light(find_settings(object.model, object.bounds, std::nullopt), &object);
  EXPECT_GT(object.sky.zenith.x(), 0.0f);
  ASSERT_EQ(object.model.lights.size(), 1u);
  EXPECT_LT(object.model.lights[0].direction.y(), 0.0) << "from above";
  EXPECT_LT(object.model.lights[0].direction.z(), 0.0) << "from before the object, where the visitor is";
}

TEST(AddLight, is_weaker_where_white_walls_light_each_other) {
  const auto lamp_of = [](float albedo) {
    Scene room;
    room.model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
    room.model.materials[0].base_colour.head<3>().setConstant(albedo);
    room.bounds = bounds_of(room.model);
    EXPECT_NEAR(mean_albedo(room.model), double{albedo}, 1e-4);
    add_light(find_settings(room.model, room.bounds, std::nullopt), &room);
    return room.eye_lamp.x();
  };
  EXPECT_NEAR(lamp_of(0.8f) * 2.68928f, lamp_of(0.5f) * 0.96875f, 0.02f);
  EXPECT_LT(lamp_of(1.0f), 0.25f * lamp_of(0.5f));
  EXPECT_GT(lamp_of(0.1f), 2.0f * lamp_of(0.5f));
}

TEST(AddLight, surrounds_an_object_that_has_lamps_of_its_own_with_grey) {
  Scene object;
  object.exposure = 2.0;
  FoundSettings found;
  found.kind = SceneKind::kObject;
  add_shadow_light(found, &object);
  EXPECT_FLOAT_EQ(object.sky.horizon.x(), 0.02f);
  EXPECT_TRUE(object.ambient.isZero());
  found.kind = SceneKind::kRoom;
  add_shadow_light(found, &object);
  EXPECT_FLOAT_EQ(object.ambient.x(), 0.02f);
}

TEST(FindExposure, gives_the_same_picture_for_a_lamp_of_any_power) {
  Scene scene;
  scene.model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  scene.bounds = bounds_of(scene.model);
  const FoundSettings found = find_settings(scene.model, scene.bounds, std::nullopt);
  EXPECT_EQ(find_exposure(found, scene), 1.0) << "no lamp";
  Light lamp;
  lamp.position = {3, 2.8, 3};
  scene.model.lights.push_back(lamp);
  const double exposure = find_exposure(found, scene);
  EXPECT_GT(exposure, 0.0);
  scene.model.lights[0].intensity *= 1000.0f;
  EXPECT_NEAR(find_exposure(found, scene), exposure / 1000.0, 1e-6 * exposure);
  scene.model.lights[0].intensity.setZero();
  EXPECT_EQ(find_exposure(found, scene), 1.0);
}

}  // namespace
}  // namespace cyclorama::scene
