// SPDX-License-Identifier: Apache-2.0
// The loop in a simulated museum, with files and a thread as in the process, but without displays: the room draws for
// the corrections in its correction.json.
#include "appliance/healing/healing_loop.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <sstream>

#include "appliance/calibration/calibration_file.h"
#include "common/base/file.h"
#include "tests/data_sets/true_calibration.h"
#include "tests/doubles/fake_clock.h"
#include "tests/support/bumped_show.h"

namespace cyclorama::healing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

/// State shared by the room and the test that bumps it.
struct Stage {
  std::mutex mutex;
  std::unique_ptr<BumpedShow> show;
  std::vector<RigidTransform<frame::Room, frame::Projector>> scanned;
  std::filesystem::path folder;
  int steps = 0;
};

class StageRoom final : public ShowRoom {
 public:
  explicit StageRoom(Stage* stage) : stage_(*stage) {}

  Result<ShowMoment> next(std::vector<std::string>*) override {
    const std::lock_guard lock(stage_.mutex);
    if (const auto file = calibration::read_show(stage_.folder / calibration::kCorrectionFile)) {
      for (std::size_t i = 0; i < file->projectors.size(); ++i) {
        const calibration::ShowFile::Projector& p = file->projectors[i];
        stage_.show->draw_for(i,
                              calibration::stepped(stage_.scanned[i], calibration::step_between(p.scanned, p.applied)));
      }
    }
    ++stage_.steps;
    return stage_.show->look();
  }

 private:
  Stage& stage_;
};

class StageRooms final : public ShowRooms {
 public:
  StageRooms(Stage* stage, std::vector<WatchingCamera> cameras) : stage_(*stage), cameras_(std::move(cameras)) {}
  [[nodiscard]] const std::vector<WatchingCamera>& cameras() const override { return cameras_; }
  [[nodiscard]] int picture_factor() const override { return 1; }
  Result<std::unique_ptr<ShowRoom>> open() override {
    {
      const std::lock_guard lock(stage_.mutex);
      stage_.show->forget_told();
    }
    return std::unique_ptr<ShowRoom>(new StageRoom(&stage_));
  }
  Result<PlacementDevices> open_for_placement() override {
    return Error(ErrorCode::kUnavailable, "nobody places here");
  }

 private:
  Stage& stage_;
  std::vector<WatchingCamera> cameras_;
};

class HealingLoopTest : public ::testing::Test {
 protected:
  HealingLoopTest() {
    std::string name = (std::filesystem::temp_directory_path() / "healing-loop-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    stage_.folder = name;
    BumpedShowOptions options;
    options.projector_width_px = 640;
    options.projector_height_px = 360;
    options.camera_megapixels = 0.2;
    options.wall_cells = 24;
    options.left_over = {0.0, 0.0, 0.0, 0.0, 0.0};  // The calibration below has its own residuals.
    auto show = BumpedShow::make(options, painted_content(3072, 3));
    CHECK(show);
    stage_.show = std::make_unique<BumpedShow>(*std::move(show));
    const simulated::TrueMuseum& truth = stage_.show->room().truth();
    CHECK(write_file_atomically(stage_.folder / "installation.toml", stage_.show->installation_text()));
    CHECK(calibration::save_calibration(stage_.folder, true_calibration(truth, "2026-11-22T10-00-00Z")));
    std::vector<PlacedCamera> placed;
    for (const calibration::ShowCamera& camera : stage_.show->calibrator().applied().cameras) {
      placed.push_back({camera.name, camera.lens, camera.T_room_camera});
      cameras_.push_back({camera.name, camera.lens});
    }
    for (const calibration::ShowProjector& p : stage_.show->calibrator().applied().projectors)
      stage_.scanned.push_back(p.T_room_projector);
    CHECK(save_camera_poses(stage_.folder, truth.installation(), placed));
  }
  ~HealingLoopTest() override {
    loop_.reset();
    std::filesystem::remove_all(stage_.folder);
  }

  void begin(bool is_recorded = false) {
    HealingLoop::Options options;
    options.period = std::chrono::milliseconds(1);
    options.on_line = [this](const std::string& line) {
      const std::lock_guard lock(stage_.mutex);
      log_ += line + "\n";
    };
    options.installation_file = stage_.folder / "installation.toml";
    if (is_recorded) options.record = stage_.folder / "record";
    loop_ =
        std::make_unique<HealingLoop>(stage_.show->room().truth().installation(), stage_.folder,
                                      std::make_unique<StageRooms>(&stage_, cameras_), clock_, &inspection_, options);
  }
  /// Returns the loop's sentence about the wall.
  [[nodiscard]] std::string says() const {
    const wire::ProcessStatus status = inspection_.status();
    for (const wire::Fact& fact : status.facts()) {
      if (fact.name() == "watch") return fact.value();
    }
    return "";
  }
  [[nodiscard]] std::string log() {
    const std::lock_guard lock(stage_.mutex);
    return log_;
  }
  /// Steps the loop until the condition holds, within a limit.
  template <typename Condition>
  bool comes(const Condition& is_so, int steps = 60) {
    int begun = -1;
    for (int tries = 0; tries < 20000; ++tries) {
      if (is_so()) return true;
      {
        const std::lock_guard lock(stage_.mutex);
        if (begun < 0) begun = stage_.steps;
        if (stage_.steps > begun + steps) break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return is_so();
  }
  bool comes_to_say(const std::string& what, int steps = 60) {
    return comes([&] { return says().find(what) != std::string::npos; }, steps);
  }
  [[nodiscard]] double off_px(std::size_t projector) {
    const std::lock_guard lock(stage_.mutex);
    return stage_.show->drawn_error_px(projector);
  }
  void bump(std::size_t projector, double turn_rad) {
    const std::lock_guard lock(stage_.mutex);
    calibration::PoseStep step = calibration::PoseStep::Zero();
    step[1] = turn_rad;
    step[0] = 0.3 * turn_rad;
    stage_.show->bump(projector, step);
  }
  [[nodiscard]] std::vector<std::string> corrections() const {
    std::vector<std::string> lines;
    const auto text = read_text_file(stage_.folder / "corrections.log", 1 << 20);
    std::istringstream all(text ? *text : "");
    for (std::string line; std::getline(all, line);) lines.push_back(line);
    return lines;
  }

  Stage stage_;
  std::vector<WatchingCamera> cameras_;
  std::string log_;
  FakeClock clock_;
  InspectionService inspection_{"calibrator"};
  std::unique_ptr<HealingLoop> loop_;
};

TEST_F(HealingLoopTest, corrects_two_projectors_that_are_bumped_at_once) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  const double before = std::max(off_px(0), off_px(2));
  bump(0, 0.006);
  bump(2, -0.005);
  EXPECT_GT(std::min(off_px(0), off_px(2)), 2.0);
  // These pictures are coarse: the pose is only certain to half a pixel.
  EXPECT_TRUE(comes([&] { return std::max(off_px(0), off_px(2)) < before + 1.0; }, 20)) << log();
  EXPECT_LT(off_px(1), 0.6);
  EXPECT_THAT(corrections(), Not(IsEmpty()));
  for (const std::string& line : corrections()) EXPECT_THAT(line, Not(HasSubstr("\"projector\": 2"))) << line;
}

TEST_F(HealingLoopTest, does_not_move_on_while_a_step_hangs) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  EXPECT_TRUE(loop_->moves_on());
  {
    const std::lock_guard hang(stage_.mutex);
    bool moves_on = true;
    // The loop may begin one more step, which renews its deadline, before it hangs.
    for (int i = 0; i < 3 && moves_on; ++i) {
      clock_.advance(std::chrono::minutes(11));
      moves_on = loop_->moves_on();
    }
    EXPECT_FALSE(moves_on);
  }
  EXPECT_TRUE(comes([&] { return loop_->moves_on(); }));
  const auto held = loop_->hold();
  clock_.advance(std::chrono::hours(10));
  EXPECT_TRUE(loop_->moves_on()) << "whoever holds it measures the wall";
}

TEST_F(HealingLoopTest, names_a_projector_that_is_off_and_uses_it_again_when_it_is_on) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  const auto lamp = [&](bool is_on) {
    const std::lock_guard lock(stage_.mutex);
    stage_.show->set_lamp(2, is_on);
  };
  lamp(false);
  EXPECT_TRUE(comes_to_say("is its lamp off, or its shutter closed?")) << says();
  EXPECT_THAT(says(), HasSubstr("keeps 2 of 3 projectors in place"));
  lamp(true);
  EXPECT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  EXPECT_THAT(corrections(), IsEmpty());
}

TEST_F(HealingLoopTest, names_a_projector_that_left_the_screen_and_keeps_the_others) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  bump(2, 0.6);  // Its light leaves the screen.
  // Its former position is dark now, as behind a closed shutter.
  EXPECT_TRUE(comes_to_say("keeps 2 of 3 projectors in place; 'projector 3' is left as it is", 10)) << says();
  bump(0, 0.006);
  const double bumped = off_px(0);
  EXPECT_TRUE(comes([&] { return off_px(0) < 0.3 * bumped; }, 30)) << log();
  for (const std::string& line : corrections()) EXPECT_THAT(line, HasSubstr("\"projector\": 1")) << line;
}

TEST_F(HealingLoopTest, resumes_a_recovery_and_does_not_take_the_bump_for_a_residual) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  ASSERT_TRUE(comes([&] {
    const auto kept = calibration::read_show(stage_.folder / calibration::kWatchFile);
    return kept && kept->projectors[1].learned;
  }));
  const double before = off_px(1);
  loop_.reset();
  bump(1, 0.004);  // The pictures are so coarse that a pixel would be followed as drift.
  EXPECT_LT(off_px(1), 5.0);
  begin();
  EXPECT_TRUE(comes([&] { return !corrections().empty(); }, 20)) << log();
  ASSERT_THAT(corrections(), Not(IsEmpty()));
  EXPECT_THAT(corrections()[0], HasSubstr("\"projector\": 2, \"kind\": \"bump\""));
  EXPECT_TRUE(comes([&] { return off_px(1) < before + 1.0; }, 5)) << log();
}

TEST_F(HealingLoopTest, reports_while_displays_cannot_be_informed_and_informs_them_later) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  // A file cannot be renamed onto a folder that is not empty.
  const std::filesystem::path file = stage_.folder / calibration::kCorrectionFile;
  ASSERT_TRUE(std::filesystem::create_directories(file / "in the way"));
  bump(1, 0.006);
  const double bumped = off_px(1);
  EXPECT_TRUE(comes_to_say("displays are not told of corrections", 20)) << says() << log();
  EXPECT_GT(off_px(1), 0.9 * bumped);
  std::filesystem::remove_all(file);
  EXPECT_TRUE(comes([&] { return off_px(1) < 0.3 * bumped; }, 20)) << says() << log();
  EXPECT_EQ(says().find("displays are not told"), std::string::npos) << says();
}

TEST_F(HealingLoopTest, works_without_a_camera_that_was_never_placed_and_names_it) {
  std::vector<PlacedCamera> placed;
  for (const calibration::ShowCamera& camera : stage_.show->calibrator().applied().cameras)
    placed.push_back({camera.name, camera.lens, camera.T_room_camera});
  placed[0].trouble = "it sees too little";
  std::filesystem::remove(stage_.folder / calibration::kWatchFile);  // Otherwise the former pose is kept.
  ASSERT_TRUE(save_camera_poses(stage_.folder, stage_.show->room().truth().installation(), placed));
  begin();
  ASSERT_TRUE(comes_to_say("nobody knows where camera 'camera 1' stands; let the cameras be placed")) << says();
  ASSERT_TRUE(comes_to_say("projectors in place")) << says();
  bump(2, 0.006);
  const double bumped = off_px(2);
  EXPECT_TRUE(comes([&] { return off_px(2) < 0.3 * bumped; }, 30)) << says() << log();
  for (const std::string& line : corrections()) EXPECT_THAT(line, HasSubstr("\"projector\": 3")) << line;
}

TEST_F(HealingLoopTest, works_without_a_projector_whose_map_gives_no_pose_and_names_it) {
  const simulated::TrueMuseum& truth = stage_.show->room().truth();
  calibration::Calibration calibration = true_calibration(truth, "2026-11-22T11-00-00Z");
  for (Eigen::Vector3d& direction : calibration.projectors[2].map.directions) direction.setConstant(std::nan(""));
  ASSERT_TRUE(calibration::save_calibration(stage_.folder, calibration));
  begin();
  EXPECT_TRUE(
      comes_to_say("keeps 2 of 3 projectors in place; 'projector 3' is left as it is: its pose cannot be "
                   "told from its map"))
      << says();
  EXPECT_THAT(says(), HasSubstr("cyclorama calibrate --quick projector 3"));
  bump(0, 0.006);
  bump(2, 0.004);  // Nothing can determine this displacement; it is not corrected, and blocks no other.
  const double bumped = off_px(0);
  EXPECT_TRUE(comes([&] { return off_px(0) < 0.3 * bumped; }, 30)) << says() << log();
  EXPECT_LT(off_px(1), 0.6);
  for (const std::string& line : corrections()) EXPECT_THAT(line, HasSubstr("\"projector\": 1")) << line;
}

TEST_F(HealingLoopTest, undoes_the_last_correction_and_does_not_repeat_it) {
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  EXPECT_EQ(loop_->undo().error().code(), ErrorCode::kNotFound);
  bump(1, 0.006);
  const double bumped = off_px(1);
  ASSERT_TRUE(comes([&] { return off_px(1) < 0.3 * bumped; }, 20)) << log();
  while (const auto undone = loop_->undo()) EXPECT_THAT(*undone, HasSubstr("projector 'projector 2'"));
  EXPECT_THAT(corrections().back(), HasSubstr("\"projector\": 2, \"kind\": \"undone\""));
  const std::size_t known = corrections().size();
  EXPECT_TRUE(comes([&] { return off_px(1) > 0.8 * bumped; }, 5)) << log();
  EXPECT_FALSE(comes([&] { return off_px(1) < 0.8 * bumped || corrections().size() > known; }, 20)) << log();
  // The same holds for another process.
  loop_.reset();
  begin();
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  EXPECT_FALSE(comes([&] { return off_px(1) < 0.8 * bumped || corrections().size() > known; }, 10)) << log();
  // Later displacements are found as usual.
  bump(1, -0.005);
  EXPECT_TRUE(comes([&] { return corrections().size() > known; }, 20)) << log();
}

/// Returns a line of a replay in the form of corrections.log, without its time.
std::string logged(const std::string& line) {
  std::size_t projector = 0;
  std::array<char, 16> kind{};
  double moved_px = 0.0;
  double sigma_px = 0.0;
  std::array<std::array<double, 7>, 2> pose{};
  auto& [a, b] = pose;
  const int read = std::sscanf(line.c_str(),
                               "correction %zu %15s %la %la before %la %la %la %la %la %la %la after %la %la %la %la "
                               "%la %la %la",
                               &projector, kind.data(), &moved_px, &sigma_px, &a[0], &a[1], &a[2], &a[3], &a[4], &a[5],
                               &a[6], &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6]);
  if (read != 18) return "";
  const auto text = [](const std::array<double, 7>& p) {
    return fmt::format(
        R"({{"rotation_wxyz": [{:.9f}, {:.9f}, {:.9f}, {:.9f}], "position_m": [{:.6f}, {:.6f}, {:.6f}]}})", p[0], p[1],
        p[2], p[3], p[4], p[5], p[6]);
  };
  return fmt::format(
      R"("projector": {}, "kind": "{}", "moved_px": {:.3f}, "sigma_px": {:.3f}, "before": {}, "after": {}}})",
      projector + 1, kind.data(), moved_px, sigma_px, text(a), text(b));
}

TEST_F(HealingLoopTest, replays_a_recorded_show_bit_by_bit_any_number_of_times) {
  begin(true);
  ASSERT_TRUE(comes_to_say("keeps 3 projectors in place")) << says();
  bump(1, 0.004);
  ASSERT_TRUE(comes([&] { return !corrections().empty(); })) << log();
  ASSERT_TRUE(loop_->realign());
  bump(0, -0.003);
  ASSERT_TRUE(comes([&] { return corrections().size() >= 2; })) << log();
  ASSERT_TRUE(loop_->undo());
  comes([] { return false; }, 3);
  loop_.reset();
  begin(true);  // Acts as another process, which resumes.
  bump(1, 0.003);
  const std::size_t known = corrections().size();
  ASSERT_TRUE(comes([&] { return corrections().size() > known; })) << log();
  loop_.reset();
  std::vector<std::filesystem::path> records;
  for (const auto& record : std::filesystem::directory_iterator(stage_.folder / "record")) records.push_back(record);
  std::ranges::sort(records);
  ASSERT_THAT(records, SizeIs(2));
  std::vector<std::string> found;
  for (const auto& record : records) {
    const auto once = replay(record);
    ASSERT_TRUE(once) << once.error().message();
    EXPECT_EQ(*once, *read_text_file(record / "report.txt", 1 << 24));
    const auto twice = replay(record);
    ASSERT_TRUE(twice);
    EXPECT_EQ(*once, *twice);
    std::istringstream lines(*once);
    for (std::string line; std::getline(lines, line);) {
      if (const std::string one = logged(line); !one.empty()) found.push_back(one);
    }
  }
  std::vector<std::string> kept = corrections();
  EXPECT_EQ(std::erase_if(kept, [](const std::string& line) { return line.find("undone") != std::string::npos; }), 1u);
  ASSERT_EQ(found.size(), kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_THAT(kept[i], HasSubstr(found[i]));
}

}  // namespace
}  // namespace cyclorama::healing
