// SPDX-License-Identifier: Apache-2.0
// Captions on walls of every shape: the display lights the simulated room's wall, which is computed without warps; from
// the sweet spot the letters must be in their direction, and nothing else may change.
//
// CYCLORAMA_SCREENSHOTS=FOLDER keeps photographs of the walls with a stop's text in four scripts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "appliance/display/display.h"
#include "common/image/colour.h"
#include "common/image/png.h"
#include "drivers/output/shared_picture.h"
#include "drivers/simulated/room/room_picture.h"
#include "kiosk/tour/caption/caption_place.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_tour.h"

namespace cyclorama::display {
namespace {

constexpr float kGrey = 0.5f;
constexpr double kReflected = 0.9;  ///< Share of the light that the simulated wall reflects.
constexpr double kDegree = std::numbers::pi / 180.0;

/// Soft stripes of letters' light, which depend on both coordinates.
double stripes(double x, double y) { return 0.5 + 0.5 * std::sin(20.0 * x) * std::cos(9.0 * y); }

class CaptionWallTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/captions.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
    const auto room = read_installation(demo_installation_path().parent_path() / GetParam());
    ASSERT_TRUE(room) << room.error().message();
    room_ = *room;
    if (screenshots() != nullptr) {  // These are as fine as a museum's.
      for (InstalledProjector& projector : room_.projectors) {
        Pinhole& lens = projector.lens;
        lens = {2 * lens.width_px, 2 * lens.height_px, 2 * lens.focal_px, 2 * lens.centre_u_px, 2 * lens.centre_v_px};
      }
    }
    DisplayOptions options;
    options.installation = room_;
    options.tour = tour_->address();
    options.output.run_dir = run_dir_;
    options.width_px = 768;
    options.refresh_hz = 60.0;
    options.attract_times = {std::chrono::minutes(10), std::chrono::milliseconds(100)};
    auto display = Display::start(std::move(options), clock_);
    ASSERT_TRUE(display) << display.error().message();
    display_ = *std::move(display);
    serving_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) display_->serve(clock_.now() + std::chrono::milliseconds(20));
    });
    ASSERT_TRUE(tour_->wait_for_display());
    show_picture();
  }
  void TearDown() override {
    if (serving_.joinable()) serving_.request_stop();
    if (serving_.joinable()) serving_.join();
    display_.reset();
    std::filesystem::remove_all(run_dir_);
  }
  static const char* screenshots() {
    return std::getenv("CYCLORAMA_SCREENSHOTS");  // NOLINT(concurrency-mt-unsafe): nobody sets it.
  }
  void show_picture() {
    const Projection wanted = room_.projection(768);
    RgbImage picture(wanted.width_px(), wanted.height_px(), linear_to_srgb8(kGrey));
    if (screenshots() != nullptr) {  // Bright and dark, so that contrast is seen on both.
      for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
          const bool is_bright = (x / 48 + y / 48) % 2 == 0;
          for (int c = 0; c < 3; ++c)
            picture.at(x, y)[c] = static_cast<std::uint8_t>(is_bright ? 235 - 30 * c : 40 + 25 * c);
        }
      }
    }
    tour_->send_all(frame_messages(1, picture, wanted, 0.0));
    ASSERT_TRUE(tour_->wait_for_reports(1, 0));
  }
  void write(const wire::Caption& caption) {
    wire::ShowMessage message;
    *message.mutable_caption() = caption;
    tour_->send_all({message});
  }
  std::vector<RgbImage> heads() {
    std::vector<RgbImage> pictures;
    for (const InstalledProjector& projector : room_.projectors) {
      RgbImage& picture = pictures.emplace_back(projector.lens.width_px, projector.lens.height_px);
      auto reader = output::SharedPictureReader::open(output::shared_picture_path(run_dir_, projector.name));
      EXPECT_TRUE(reader && reader->read_newest(&picture));
    }
    return pictures;
  }
  /// Waits until the heads no longer change, and returns their pictures.
  std::vector<RgbImage> settled() {
    std::vector<RgbImage> before;
    std::vector<RgbImage> now = heads();
    for (int same = 0; same < 3; same = now == before ? same + 1 : 0) {
      clock_.wait_until(clock_.now() + std::chrono::seconds(2));
      before = std::exchange(now, heads());
    }
    return now;
  }
  /// Returns the caption's coordinates of a direction from the sweet spot; computed apart from the display's matrices.
  [[nodiscard]] std::optional<Eigen::Vector2d> on_caption(const wire::Caption& caption,
                                                          const Eigen::Vector3d& d) const {
    const Eigen::AngleAxisd turned(caption.azimuth_rad(), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d level = turned * d;  // Its azimuth counts from the caption's middle.
    if (level.z() >= 0.0) return std::nullopt;
    const PictureShape shape = room_.picture(768);
    Eigen::Vector2d off;  // From the middle, to the right and upwards.
    if (std::holds_alternative<Panorama>(shape)) {
      off = {std::atan2(level.x(), -level.z()),
             level.y() / std::hypot(level.x(), level.z()) - std::tan(caption.elevation_rad())};
    } else if (std::holds_alternative<Perspective>(shape)) {
      off = {d.x() / -d.z() - std::tan(caption.azimuth_rad()),
             d.y() / -d.z() - std::tan(caption.elevation_rad()) / std::cos(caption.azimuth_rad())};
    } else {
      const Eigen::Vector3d ahead = Eigen::AngleAxisd(-caption.elevation_rad(), Eigen::Vector3d::UnitX()) * level;
      if (ahead.z() >= -0.1) return std::nullopt;
      off = {ahead.x() / -ahead.z(), ahead.y() / -ahead.z()};
    }
    return Eigen::Vector2d(0.5 + off.x() / caption.width(), 0.5 - off.y() / caption.height());
  }

  SteadyClock clock_;
  std::filesystem::path run_dir_;
  Installation room_;
  std::unique_ptr<FakeTour> tour_ = FakeTour::start();
  std::unique_ptr<Display> display_;
  std::jthread serving_;
};

TEST_P(CaptionWallTest, puts_letters_where_their_direction_is) {
  if (screenshots() != nullptr) GTEST_SKIP() << "the pictures are for people";
  wire::Caption caption;
  caption.set_width_px(400);
  caption.set_height_px(200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 400; ++x)
      caption.mutable_ink()->push_back(
          static_cast<char>(std::lround(255.0 * stripes((x + 0.5) / 400.0, (y + 0.5) / 200.0))));
  }
  caption.set_width(0.6);
  caption.set_height(0.3);
  caption.set_azimuth_rad(0.2);
  caption.set_elevation_rad(0.1);
  write(caption);
  const simulated::RoomPicture photographer(room_, simulated::RoomEye::behind_visitor(room_, 16, 9));
  double inside = 1.0;
  double outside = 1.0;
  const TimePoint deadline = clock_.now() + std::chrono::seconds(60);
  constexpr double kMaxInside = 0.02;
  constexpr double kMaxOutside = 0.006;
  int inside_count = 0;
  while ((inside >= kMaxInside || outside >= kMaxOutside) && clock_.now() < deadline) {
    const std::vector<RgbImage> lit = heads();
    inside = outside = 0.0;
    inside_count = 0;
    int outside_count = 0;
    for (const WallPatch& patch : patches(room_.wall, 8000)) {
      const double seen = photographer.radiance_at(patch.middle, lit)[1] / kReflected;
      const auto at = on_caption(caption, patch.middle.xyz - room_.sweet_spot.xyz);
      const double edge = at ? 0.5 - (*at - Eigen::Vector2d(0.5, 0.5)).cwiseAbs().maxCoeff() : -1.0;
      if (edge > 0.05) {
        const double ink = stripes(at->x(), at->y());
        inside += std::abs(seen - (ink * kInkLight + (1.0 - ink) * kPlateLeaves * static_cast<double>(kGrey)));
        ++inside_count;
      } else if (edge < -0.02) {
        outside += std::abs(seen - static_cast<double>(kGrey));
        ++outside_count;
      }
    }
    ASSERT_GT(inside_count, 50);
    inside /= inside_count;
    outside /= outside_count;
  }
  std::printf("%s: letters off by %.4f of a projector's white on average, the picture beside them by %.4f\n",
              GetParam(), inside, outside);
  EXPECT_LT(inside, kMaxInside);
  EXPECT_LT(outside, kMaxOutside);
}

TEST_P(CaptionWallTest, photographs_of_four_scripts) {
  if (screenshots() == nullptr) GTEST_SKIP() << "set CYCLORAMA_SCREENSHOTS=FOLDER for pictures";
  auto setter = tour::CaptionSetter::open();
  ASSERT_TRUE(setter);
  const tour::CaptionStyle style{{}, 40.0 / 60.0 * kDegree, 34.0 * kDegree, 0.0, {}};
  const wire::DisplayHello& hello = tour_->hello;
  const tour::CaptionWall wall{room_.picture(768), hello.min_px_per_rad(), hello.max_px_per_rad()};
  const auto set = [&](const std::string& name, const std::vector<tour::CaptionText>& texts) {
    const auto pages = setter->set(texts, tour::caption_size(style, wall, texts.size()));
    ASSERT_TRUE(pages) << pages.error().message();
    write(tour::caption_on_wall(pages->front(), style, wall));
    const std::vector<RgbImage> lit = settled();
    // From the sweet spot's side of the room, and near the caption.
    simulated::RoomEye eye = simulated::RoomEye::behind_visitor(room_, 1600, 900);
    const std::string wall_name = std::string(GetParam()).substr(0, std::string(GetParam()).find('.'));
    for (const char* const distance : {"far", "near"}) {
      const simulated::RoomPicture photographer(room_, eye);
      std::string file = wall_name;
      file.append("-").append(name).append("-").append(distance).append(".png");
      ASSERT_TRUE(write_png(std::filesystem::path(screenshots()) / file, photographer.photograph(lit)));
      eye.lens.focal_px *= 2.6;
      eye.lens.centre_v_px += 620.0;
    }
  };
  set("en-zh",
      {{"en", "The reclining Buddha", "He lies on his right side, at the moment of his passing: clay on sandstone."},
       {"zh-Hant", "臥佛", "佛陀右脅而臥，入於涅槃。泥塑，砂岩胎，唐代。"}});
  set("ar-el", {{"ar", "بوذا المضطجع", "يرقد على جنبه الأيمن في لحظة رحيله: طين على حجر رملي."},
                {"el", "Ο ξαπλωμένος Βούδας", "Πηλός πάνω σε ψαμμίτη, 8ος αιώνας."}});
}

INSTANTIATE_TEST_SUITE_P(Demo, CaptionWallTest,
                         ::testing::Values("installation.toml", "plane.toml", "corner.toml", "dome.toml", "mesh.toml"),
                         [](const auto& tested) {
                           const std::string name = tested.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace cyclorama::display
