// SPDX-License-Identifier: Apache-2.0
// Start, storage and records of the continuous calibration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "appliance/calibration/calibration_file.h"
#include "appliance/calibration/colour_file.h"
#include "appliance/calibration/corrected_map.h"
#include "appliance/calibration/pose_step.h"
#include "appliance/healing/correction_log.h"
#include "appliance/healing/estimator/show_fit.h"
#include "appliance/healing/healing_health.h"
#include "appliance/healing/healing_start.h"
#include "appliance/healing/show_record.h"
#include "common/base/file.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/exact_calibration.h"

namespace cyclorama::healing {
namespace {

using ::testing::HasSubstr;

calibration::BrownParameters lens_of(const Pinhole& p) {
  return {p.width_px, p.height_px, p.focal_px, p.pixel_aspect * p.focal_px, p.centre_u_px, p.centre_v_px};
}

calibration::ShowFile::Projector installed(const InstalledProjector& p) {
  return {p.name, lens_of(p.lens), p.T_room_projector, p.T_room_projector, {}};
}

calibration::PoseStep small_step() {
  calibration::PoseStep step;
  step << 0.004, -0.007, 0.003, 0.005, -0.002, 0.006;
  return step;
}

double max_distance(const calibration::MeasuredMap& a, const calibration::MeasuredMap& b) {
  double max = 0.0;
  for (std::size_t i = 0; i < a.directions.size(); ++i) {
    if (a.directions[i].allFinite() && b.directions[i].allFinite())
      max = std::max(max, (a.directions[i] - b.directions[i]).norm());
  }
  return max;
}

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "healing-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

TEST(ShowFile, survives_a_round_trip) {
  const Installation room = demo_room();
  calibration::ShowFile show;
  show.calibration = "2026-11-22T10-00-00Z";
  for (const InstalledProjector& p : room.projectors) show.projectors.push_back(installed(p));
  show.projectors[0].applied = calibration::stepped(show.projectors[0].scanned, small_step());
  const calibration::PoseMatrix root = calibration::PoseMatrix::Random() * 1e-4;
  show.projectors[0].learned = {
      calibration::stepped(show.projectors[0].scanned, calibration::PoseStep(0.5 * small_step())),
      calibration::stepped(show.projectors[0].scanned, calibration::PoseStep(0.4 * small_step())), root};
  show.cameras.push_back({"by the \"left\" one", lens_of(room.projectors[0].lens), {}});
  const auto read = calibration::parse_show(calibration::show_json(show), "watch.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->calibration, show.calibration);
  ASSERT_EQ(read->projectors.size(), show.projectors.size());
  EXPECT_LT(calibration::step_between(read->projectors[0].applied, show.projectors[0].applied).norm(), 1e-14);
  ASSERT_TRUE(read->projectors[0].learned && !read->projectors[1].learned);
  EXPECT_LT(calibration::step_between(read->projectors[0].learned->at_rest, show.projectors[0].learned->at_rest).norm(),
            1e-14);
  EXPECT_EQ(read->projectors[0].learned->root, root);
  EXPECT_EQ(calibration::to_block(read->projectors[0].lens), calibration::to_block(show.projectors[0].lens));
  EXPECT_EQ(read->cameras[0].name, show.cameras[0].name);
}

TEST(ShowFile, keeps_responses_and_missing_poses_bit_by_bit) {
  calibration::ShowFile show;
  show.calibration = "x";
  show.projectors.push_back(installed(demo_room().projectors[0]));
  show.projectors[0].unplaced = "nobody \"measured\" it";
  show.projectors[0].light.emplace();
  show.projectors[0].light->fill(calibration::rounded_light(calibration::gamma_light(1.8)));
  const auto read = calibration::parse_show(calibration::show_json(show), "watch.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->projectors[0].unplaced, show.projectors[0].unplaced);
  EXPECT_EQ(read->projectors[0].light, show.projectors[0].light);
  std::string bad = calibration::show_json(show);
  bad.replace(bad.find("65535\n"), 5, "65536");
  EXPECT_FALSE(calibration::parse_show(bad, "watch.json"));
}

/// A calibrated room of three projectors, and the pose of a camera in it.
struct CalibratedRoom {
  CalibratedRoom() {
    calibration = exact_calibration(room, "2026-11-22T10-00-00Z");
    const RigidTransform<frame::Room, frame::Projector>& T = room.projectors[1].T_room_projector;
    placed.name = "seen";
    placed.lens = {640, 480, 500.0, 500.0, 320.0, 240.0};
    placed.T_room_camera = {T.rotation(), T.translation()};
  }
  Result<HealingStart> start(const std::vector<WatchingCamera>& cameras) {
    TRY(calibration::save_calibration(folder.path, calibration));
    TRY(save_camera_poses(folder.path, room, {placed}));
    return healing_start(folder.path, room, cameras);
  }
  Folder folder;
  Installation room = demo_room_with_pixels_over(8);
  calibration::Calibration calibration;
  PlacedCamera placed;
};

TEST(HealingStart, uses_what_is_valid_and_names_the_rest) {
  CalibratedRoom room;
  for (Eigen::Vector3d& direction : room.calibration.projectors[0].map.directions) direction.setConstant(std::nan(""));
  room.calibration.projectors.pop_back();
  const auto start = room.start({{"never placed", room.placed.lens}, {"seen", room.placed.lens}});
  ASSERT_TRUE(start) << start.error().message();
  EXPECT_EQ(start->cameras, std::vector<std::size_t>{1});
  ASSERT_EQ(start->troubles.size(), 1u);
  EXPECT_THAT(start->troubles[0], HasSubstr("'never placed' stands; let the cameras be placed"));
  ASSERT_EQ(start->show.projectors.size(), 3u);
  EXPECT_THAT(start->show.projectors[0].unplaced, HasSubstr("cannot be told from its map"));
  EXPECT_EQ(start->show.projectors[1].unplaced, "");
  EXPECT_THAT(start->show.projectors[2].unplaced, HasSubstr("knows nothing of it; calibrate it with"));
  // Without a camera, nothing can be kept in place.
  EXPECT_EQ(healing_start(room.folder.path, room.room, {{"never placed", room.placed.lens}}).error().code(),
            ErrorCode::kNotFound);
}

TEST(HealingStart, projectors_come_in_the_installations_order) {
  CalibratedRoom room;
  const std::vector<WatchingCamera> cameras{{"seen", room.placed.lens}};
  ASSERT_TRUE(room.start(cameras));
  std::ranges::reverse(room.room.projectors);
  const auto start = healing_start(room.folder.path, room.room, cameras);
  ASSERT_TRUE(start) << start.error().message();
  ASSERT_EQ(start->show.projectors.size(), room.room.projectors.size());
  for (std::size_t i = 0; i < room.room.projectors.size(); ++i)
    EXPECT_EQ(start->show.projectors[i].name, room.room.projectors[i].name);
}

TEST(HealingStart, predicts_with_the_measured_responses) {
  CalibratedRoom room;
  calibration::CalibratedColour colour;
  colour.name = room.room.projectors[1].name;
  colour.colour.response.emplace();
  constexpr double kGamma[] = {1.6, 2.0, 2.7};
  for (std::size_t c = 0; c < 3; ++c) (*colour.colour.response)[c] = warp::ResponseCurve::power(kGamma[c], 65);
  const std::vector<WatchingCamera> cameras{{"seen", room.placed.lens}};
  const auto before = room.start(cameras);
  ASSERT_TRUE(before) << before.error().message();
  EXPECT_FALSE(before->show.projectors[1].light);
  const auto own = calibration::calibration_folder(room.folder.path, room.calibration.date);
  ASSERT_TRUE(write_file_atomically(own / "colours.json", calibration::colours_json(std::span(&colour, 1))));
  const auto start = healing_start(room.folder.path, room.room, cameras);
  ASSERT_TRUE(start) << start.error().message();
  const calibration::ShowCalibration show = applied_room(start->show, room.room, 1);
  for (std::size_t code = 0; code < 256; ++code) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(show.projectors[1].light[c][code], std::pow(static_cast<double>(code) / 255.0, kGamma[c]), 2e-3);
    }
    EXPECT_NEAR(show.projectors[0].light[0][code], std::pow(static_cast<double>(code) / 255.0, 2.2), 1e-5);
  }
}

TEST(CorrectionLog, finds_the_last_correction_that_was_not_undone) {
  const Folder folder;
  const Installation room = demo_room();
  std::vector<RigidTransform<frame::Room, frame::Projector>> at;
  for (const InstalledProjector& p : room.projectors) at.push_back(p.T_room_projector);
  EXPECT_FALSE(last_correction(folder.path, at));
  const auto first = at[0];
  std::vector<LoggedCorrection> made;
  for (int i = 0; i < 3; ++i) {
    const auto before = at[0];
    at[0] = calibration::stepped(before, small_step());
    made.push_back({utc_now(), i == 1 ? "drift" : "bump", 0, 1.0 + i, 0.1, before, at[0]});
  }
  log_corrections(folder.path, made);
  for (int i = 2; i >= 0; --i) {
    const auto last = last_correction(folder.path, at);
    ASSERT_TRUE(last);
    EXPECT_NEAR(last->moved_px, 1.0 + i, 1e-3);
    const LoggedCorrection undone{utc_now(), "undone", 0, last->moved_px, 0.1, last->after, last->before};
    log_corrections(folder.path, std::span(&undone, 1));
    at[0] = last->before;
  }
  EXPECT_LT(calibration::step_between(at[0], first).norm(), 1e-5);
  EXPECT_FALSE(last_correction(folder.path, at));
  const auto again = parse_correction(correction_line(made[1]));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->kind, "drift");
  EXPECT_LT(calibration::step_between(again->after, made[1].after).norm(), 1e-5);
  // Invalid lines in the file are skipped.
  ASSERT_TRUE(write_file_atomically(folder.path / "corrections.log", std::string_view("{\n[]\n{\"kind\": 3}\n\n")));
  EXPECT_FALSE(last_correction(folder.path, at));
}

TEST(ShowFile, names_the_position_of_a_mistake) {
  calibration::ShowFile show;
  show.calibration = "x";
  show.projectors.push_back(installed(demo_room().projectors[0]));
  const std::string good = calibration::show_json(show);
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string bad = good;
    bad.replace(bad.find(what), what.size(), by);
    return calibration::parse_show(bad, "watch.json");
  };
  const auto unknown = with("\"scanned\"", "\"scaned\"");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(unknown.error().message(), HasSubstr("/projectors/0"));
  EXPECT_FALSE(with("\"version\": 2", "\"version\": 1"));
  EXPECT_FALSE(with("\"width_px\"", "\"with_px\""));
  EXPECT_FALSE(calibration::parse_show("", "watch.json"));
  EXPECT_FALSE(calibration::parse_show("[]", "watch.json"));
  for (std::size_t cut = 0; cut < good.size() - 3; cut += 7)
    EXPECT_FALSE(calibration::parse_show(good.substr(0, cut), "watch.json"));
}

TEST(CorrectedMap, does_not_change_where_nothing_moved) {
  const Installation room = demo_room_with_pixels_over(8);
  const calibration::Calibration scanned = exact_calibration(room, "x", 0.01);
  const calibration::MeasuredMap same =
      calibration::corrected_map(scanned.projectors[0].map, installed(room.projectors[0]), room.wall, room.sweet_spot);
  for (std::size_t i = 0; i < same.directions.size(); ++i) {
    if (!same.directions[i].allFinite()) continue;
    EXPECT_EQ(same.directions[i], scanned.projectors[0].map.directions[i]);
  }
  EXPECT_EQ(moved_px(installed(room.projectors[0]), room.wall), 0.0);
}

TEST(CorrectedMap, is_the_map_of_the_displaced_projector) {
  Installation room = demo_room_with_pixels_over(8);
  const calibration::Calibration before = exact_calibration(room, "x");
  for (std::size_t i = 0; i < room.projectors.size(); ++i) {
    calibration::ShowFile::Projector moved = installed(room.projectors[i]);
    moved.applied = calibration::stepped(moved.scanned, small_step());
    EXPECT_GT(moved_px(moved, room.wall), 0.3);
    const calibration::MeasuredMap corrected =
        calibration::corrected_map(before.projectors[i].map, moved, room.wall, room.sweet_spot);
    room.projectors[i].T_room_projector = moved.applied;
    const calibration::MeasuredMap exact = exact_calibration(room, "x").projectors[i].map;
    EXPECT_LT(max_distance(corrected, exact), 1e-9);
    EXPECT_GT(max_distance(before.projectors[i].map, exact), 1e-3);
  }
}

TEST(ShowFit, locates_a_projector_by_its_map) {
  Installation room = demo_room_with_pixels_over(4);
  calibration::ShowProjector start;
  start.lens = lens_of(room.projectors[1].lens);
  start.T_room_projector = room.projectors[1].T_room_projector;
  // Its pose differs from the installer's file.
  room.projectors[1].T_room_projector =
      calibration::stepped(start.T_room_projector, calibration::PoseStep(3.0 * small_step()));
  room.projectors[1].lens.focal_px *= 1.01;
  const calibration::MeasuredMap map = exact_calibration(room, "x").projectors[1].map;
  const auto fitted = fit_projector(map, room.wall, room.sweet_spot, start);
  ASSERT_TRUE(fitted) << fitted.error().message();
  EXPECT_LT(fitted->rms_px, 0.1);
  calibration::ShowFile::Projector found{"", fitted->lens, fitted->pose, room.projectors[1].T_room_projector, {}};
  EXPECT_LT(calibration::step_between(found.scanned, found.applied).tail<3>().norm(), 0.05)
      << "where it is, is told by the wall's depth";
  calibration::MeasuredMap none = map;
  for (Eigen::Vector3d& direction : none.directions) direction.setConstant(std::nan(""));
  EXPECT_EQ(fit_projector(none, room.wall, room.sweet_spot, start).error().code(), ErrorCode::kInvalidArgument);
}

TEST(ShowFit, places_a_camera_although_a_third_of_its_pixels_are_wrong) {
  const Installation room = demo_room();
  const calibration::BrownParameters lens{640, 480, 500.0, 500.0, 321.0, 239.0, -0.05, 0.01, 1e-4, -2e-4, 0.0};
  calibration::ShowCamera camera{"", lens, {}, {}};
  const RigidTransform<frame::Room, frame::Camera> truth(
      room.projectors[1].T_room_projector.rotation(),
      room.projectors[1].T_room_projector.translation() + Eigen::Vector3d(0.2, -0.1, 0.3));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::uniform_real_distribution<double> anywhere(0.0, 480.0);
  std::vector<WallCorrespondence> pixels;
  for (double v = 10.0; v < 480.0; v += 20.0) {
    for (double u = 10.0; u < 640.0; u += 20.0) {
      const auto slope = calibration::slope_at(lens, {u, v});
      ASSERT_TRUE(slope);
      const auto at = hit_extended(room.wall, {{truth.translation()}, truth.rotation() * slope->homogeneous()});
      if (!at) continue;
      const bool is_wrong = pixels.size() % 3 == 0;
      pixels.push_back({is_wrong ? Eigen::Vector2d(anywhere(random), anywhere(random))
                                 : Eigen::Vector2d(u + noise(random), v + noise(random)),
                        at->xyz});
    }
  }
  const auto placed = place_camera(lens, pixels);
  ASSERT_TRUE(placed) << placed.error().message();
  EXPECT_LT((placed->pose.translation() - truth.translation()).norm(), 3e-3);
  EXPECT_LT(calibration::step_between(placed->pose, truth).head<3>().norm(), 1e-3);
  EXPECT_FALSE(place_camera(lens, std::span(pixels).first(20)));
}

/// A room of one small projector and one small camera, with pictures of noise.
struct SmallShow {
  SmallShow() {
    const Installation room = demo_room_with_pixels_over(16);
    const InstalledProjector& p = room.projectors[1];
    show.wall = room.wall;
    show.sweet_spot = room.sweet_spot;
    calibration::ShowProjector projector;
    projector.name = p.name;
    projector.lens = lens_of(p.lens);
    projector.T_room_projector = p.T_room_projector;
    projector.light.fill(calibration::gamma_light(2.2));
    show.projectors.push_back(projector);
    show.cameras.push_back({"camera",
                            {160, 120, 100.0, 100.0, 80.0, 60.0},
                            {p.T_room_projector.rotation(), p.T_room_projector.translation()},
                            calibration::gamma_light(1.0)});
  }
  ShowMoment moment(int number) const {
    std::mt19937 random(static_cast<unsigned>(number));
    RgbImage shown(show.projectors[0].lens.width_px, show.projectors[0].lens.height_px);
    GreyImage seen(160, 120);
    for (std::uint8_t& code : shown.data()) code = static_cast<std::uint8_t>(random());
    for (std::uint8_t& code : seen.data()) code = static_cast<std::uint8_t>(random());
    const TimePoint now = TimePoint{} + std::chrono::seconds(100) + number * std::chrono::milliseconds(250);
    ShowMoment made;
    made.now = now;
    made.shown.push_back({0, now - std::chrono::milliseconds(90), std::make_shared<const RgbImage>(shown),
                          static_cast<std::uint64_t>(number + 1)});
    made.until.push_back({0, now + std::chrono::milliseconds(50), static_cast<std::uint64_t>(number + 1)});
    made.seen.push_back({0, now - std::chrono::milliseconds(40), now, std::make_shared<const GreyImage>(seen)});
    return made;
  }
  calibration::ShowCalibration show;
};

TEST(ShowRecord, replays_bit_by_bit) {
  const Folder folder;
  const SmallShow small;
  std::string lines;
  {
    auto recorder = ShowRecorder::begin(folder.path, demo_installation_path(), {small.show, std::nullopt});
    ASSERT_TRUE(recorder) << recorder.error().message();
    const auto read = ShowRecord::open(folder.path);
    ASSERT_TRUE(read) << read.error().message();
    auto calibrator = ContinuousCalibrator::make(read->start().applied);
    ASSERT_TRUE(calibrator);
    for (int i = 0; i < 12; ++i) {
      const ShowMoment moment = small.moment(i);
      if (i == 6) {
        calibrator->realign();
        ASSERT_TRUE(recorder->add_realignment());
      }
      const ShowReport report = calibrator->step(moment);
      lines += report_lines(report);
      ASSERT_TRUE(recorder->add(moment, report));
    }
  }
  EXPECT_FALSE(lines.empty());
  EXPECT_EQ(*read_text_file(folder.path / "report.txt", 1 << 20), lines);
  const auto again = replay(folder.path);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(*again, lines);
}

TEST(ShowRecord, replays_an_undone_correction) {
  const Folder folder;
  const SmallShow small;
  const calibration::PoseMatrix root = 1e-4 * calibration::PoseMatrix::Identity();
  const auto& there = small.show.projectors[0].T_room_projector;
  const RecordStart start{small.show, LearnedRoom{small.show, {there}, {root, root}}, 1};
  {
    auto recorder = ShowRecorder::begin(folder.path, demo_installation_path(), start);
    ASSERT_TRUE(recorder);
    ASSERT_TRUE(recorder->add(small.moment(0), {}));
    ASSERT_TRUE(recorder->add_put_back(0, calibration::stepped(there, small_step())));
    ASSERT_TRUE(recorder->add(small.moment(1), {}));
  }
  auto record = ShowRecord::open(folder.path);
  ASSERT_TRUE(record) << record.error().message();
  auto calibrator = record->start().begin();
  ASSERT_TRUE(calibrator);
  int put_back = 0;
  for (;;) {
    const auto event = record->next();
    ASSERT_TRUE(event);
    if (!*event) break;
    if (!(*event)->put_back) {
      EXPECT_TRUE(calibrator->step((*event)->moment).corrections.empty());
      continue;
    }
    ++put_back;
    EXPECT_EQ(*(*event)->put_back, 0u);
    ASSERT_TRUE(calibrator->put_back(0, (*event)->position));
    EXPECT_LT(calibration::step_between(calibrator->applied().projectors[0].T_room_projector,
                                        calibration::stepped(there, small_step()))
                  .norm(),
              1e-12);
    const auto learned = calibrator->learned();
    ASSERT_TRUE(learned);
    // The believed pose would be right if the restored one were.
    EXPECT_LT(calibration::step_between(learned->at_rest[0], learned->believed.projectors[0].T_room_projector).norm(),
              2e-4);
  }
  EXPECT_EQ(put_back, 1);
}

TEST(ShowRecord, ends_where_it_was_cut_and_refuses_other_files) {
  const Folder folder;
  const SmallShow small;
  {
    const LearnedRoom learned{small.show,
                              {small.show.projectors[0].T_room_projector},
                              {calibration::PoseMatrix::Identity(), calibration::PoseMatrix::Identity()}};
    auto recorder = ShowRecorder::begin(folder.path, demo_installation_path(), {small.show, learned});
    ASSERT_TRUE(recorder);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(recorder->add(small.moment(i), {}));
  }
  const auto whole = *read_file(folder.path / "show.record", 1 << 24);
  const auto events_of = [&](std::size_t bytes) {
    CHECK(write_file_atomically(folder.path / "show.record", std::span(whole).first(bytes)));
    int events = -1;
    auto record = ShowRecord::open(folder.path);
    if (!record) return events;
    for (events = 0;; ++events) {
      const auto event = record->next();
      CHECK(event);
      if (!*event) return events;
    }
  };
  EXPECT_EQ(events_of(whole.size()), 2);
  EXPECT_EQ(events_of(whole.size() - 1), 1);
  EXPECT_EQ(events_of(4), -1);
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += 997) EXPECT_LE(events_of(bytes), 1);
  // A picture whose declared size exceeds the file's.
  auto damaged = whole;
  std::size_t at = 12;
  for (int i = 0; i < 2; ++i) {
    std::uint32_t size = 0;
    std::memcpy(&size, damaged.data() + at, 4);
    at += 4 + size;
  }
  const std::uint32_t huge = 16000;
  std::memcpy(damaged.data() + at + 1 + 8 + 4 + 4 + 8 + 8, &huge, 4);
  ASSERT_TRUE(write_file_atomically(folder.path / "show.record", std::span<const std::byte>(damaged)));
  auto record = ShowRecord::open(folder.path);
  ASSERT_TRUE(record);
  const auto event = record->next();
  EXPECT_TRUE(!event || !*event);
}

TEST(ShowRecord, ends_at_its_maximum_size_counting_all_of_its_folder) {
  const Folder folder;
  const SmallShow small;
  EXPECT_EQ(record_bytes(folder.path / "none"), 0u);
  const std::filesystem::path one = folder.path / "one";
  const ShowMoment moment = small.moment(1);
  const std::size_t pictures = moment.shown[0].picture->data().size() + moment.seen[0].picture->data().size();
  auto recorder = ShowRecorder::begin(one, demo_installation_path(), {small.show, std::nullopt}, 3 * pictures);
  ASSERT_TRUE(recorder) << recorder.error().message();
  ASSERT_TRUE(recorder->add(moment, {}));
  EXPECT_GT(record_bytes(folder.path), pictures);
  Status added = Done{};
  for (int i = 0; i < 3 && added; ++i) added = recorder->add(moment, {});
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code(), ErrorCode::kBusy);
  EXPECT_LE(std::filesystem::file_size(one / "show.record"), 3 * pictures);
}

TEST(HealingHealth, reports_which_projectors_are_held_and_why) {
  HealingHealth health({"left", "right"}, 2.0);
  EXPECT_EQ(health.sentence(), "begins to watch the wall");
  ShowReport report;
  report.projectors.resize(2);
  for (ProjectorHealth& one : report.projectors) one.hold = HoldReason::kNone;
  report.corrections.push_back({1, {}, {}, 5.0, 0.1, true});
  const TimePoint now = TimePoint{} + std::chrono::seconds(50);
  health.take(report, now);
  EXPECT_EQ(health.sentence(), "keeps 2 projectors in place");
  const wire::Table table = health.projectors(now + std::chrono::seconds(7));
  ASSERT_EQ(table.rows_size(), 2);
  EXPECT_EQ(table.columns_size(), table.rows(0).cells_size());
  EXPECT_FALSE(table.rows(0).cells(6).has_number());
  EXPECT_EQ(table.rows(1).cells(6).number(), 10.0) << "of its own pixels";
  EXPECT_EQ(table.rows(1).cells(7).number(), 7.0);
  report.corrections.clear();
  report.projectors[0] = {HoldReason::kInTheWay, "something stands in the way", 0.0, 0.1, true};
  health.take(report, now + std::chrono::seconds(1));
  EXPECT_THAT(health.sentence(), HasSubstr("keeps 1 of 2 projectors in place; 'left' is left as it is"));
  EXPECT_FALSE(health.is_well());
  for (int i = 0; i < 1000; ++i) health.take(report, now + i * HealingHealth::kEvery);
  EXPECT_EQ(static_cast<std::size_t>(health.history(now).rows_size()), HealingHealth::kMaxSamples);
}

}  // namespace
}  // namespace cyclorama::healing
