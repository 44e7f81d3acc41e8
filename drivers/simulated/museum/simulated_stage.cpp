// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/simulated_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "common/base/check.h"
#include "drivers/simulated/museum/simulated_show.h"

namespace cyclorama::simulated {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Camera offset from its projector's lens: right, down, forward.
const Eigen::Vector3d kBeside_m(0.12, 0.1, 0.0);

std::vector<FixedCamera> cameras_beside(const MuseumTruth& truth, const SimulatedStage::Options& options) {
  std::vector<FixedCamera> cameras;
  for (const TrueProjector& projector : truth.projectors) {
    FixedCamera camera;
    camera.optics = truth.camera;
    const int height = static_cast<int>(std::lround(std::sqrt(1e6 * options.camera_megapixels / (4.0 / 3.0))));
    const Pinhole lens = Pinhole::from_field_of_view(height * 4 / 3, height, options.camera_field_deg * kDegree);
    camera.optics.lens = TrueLens(lens, truth.camera.lens.radial(), truth.camera.lens.tangential());
    camera.optics.bits = 8;
    const Eigen::Quaterniond& turn = projector.T_room_projector.rotation();
    camera.T_room_camera = {turn, projector.T_room_projector.translation() + turn * kBeside_m};
    cameras.push_back(camera);
  }
  return cameras;
}

RgbImage enlarged(const RgbImage& picture, int factor, int width, int height) {
  RgbImage made(width, height);
  for (int y = 0; y < height; ++y) {
    // Interpolates between pixel centres.
    const double v = std::clamp((y + 0.5) / factor - 0.5, 0.0, picture.height() - 1.0);
    const int y0 = static_cast<int>(v);
    const int y1 = std::min(y0 + 1, picture.height() - 1);
    for (int x = 0; x < width; ++x) {
      const double u = std::clamp((x + 0.5) / factor - 0.5, 0.0, picture.width() - 1.0);
      const int x0 = static_cast<int>(u);
      const int x1 = std::min(x0 + 1, picture.width() - 1);
      for (int c = 0; c < 3; ++c) {
        const double above = (1.0 - (u - x0)) * picture.at(x0, y0)[c] + (u - x0) * picture.at(x1, y0)[c];
        const double below = (1.0 - (u - x0)) * picture.at(x0, y1)[c] + (u - x0) * picture.at(x1, y1)[c];
        made.at(x, y)[c] = static_cast<std::uint8_t>((1.0 - (v - y0)) * above + (v - y0) * below + 0.5);
      }
    }
  }
  return made;
}

}  // namespace

struct SimulatedStage::State {
  State(SimulatedShow of, std::filesystem::path file) : show(std::move(of)), truth_file(std::move(file)) {
    pictures.resize(show.truth().truth().projectors.size());
    std::error_code ignored;
    read_at = std::filesystem::last_write_time(truth_file, ignored);
  }
  /// Updates the poses of devices that were moved.
  Status take_bumps() {
    std::error_code failed;
    const auto written_at = std::filesystem::last_write_time(truth_file, failed);
    if (failed || written_at == read_at) return Done{};
    TRY_ASSIGN(const MuseumTruth now, MuseumTruth::read(truth_file));
    read_at = written_at;
    for (std::size_t i = 0; i < now.projectors.size() && i < pictures.size(); ++i) {
      const auto& pose = now.projectors[i].T_room_projector;
      const auto& was = show.truth().truth().projectors[i].T_room_projector;
      if (pose.rotation().coeffs() == was.rotation().coeffs() && pose.translation() == was.translation()) continue;
      TRY(show.move_projector(i, pose));
      TRY(show.show(i, pictures[i]));
    }
    return Done{};
  }

  mutable std::mutex mutex;  ///< Guards all members.
  SimulatedShow show;
  std::filesystem::path truth_file;
  std::filesystem::file_time_type read_at;
  std::vector<RgbImage> pictures;
};

SimulatedStage::SimulatedStage(std::unique_ptr<State> state) : state_(std::move(state)) {}
SimulatedStage::SimulatedStage(SimulatedStage&&) noexcept = default;
SimulatedStage& SimulatedStage::operator=(SimulatedStage&&) noexcept = default;
SimulatedStage::~SimulatedStage() = default;

Result<SimulatedStage> SimulatedStage::open(const std::filesystem::path& installation, const Options& options) {
  TRY_ASSIGN(Installation room, read_installation(installation));
  const std::filesystem::path file = truth_path_beside(installation);
  TRY_ASSIGN(MuseumTruth truth, MuseumTruth::read(file));
  truth.cells = options.wall_cells;
  std::vector<FixedCamera> cameras = cameras_beside(truth, options);
  TRY_ASSIGN(SimulatedShow show,
             SimulatedShow::make(std::move(room), std::move(truth), std::move(cameras), options.threads));
  return SimulatedStage(std::make_unique<State>(std::move(show), file));
}

std::size_t SimulatedStage::camera_count() const { return state_->show.cameras().size(); }

SimulatedStage::Lens SimulatedStage::lens(std::size_t camera) const {
  CHECK(camera < camera_count());
  const TrueLens& lens = state_->show.cameras()[camera].optics.lens;
  const Pinhole& p = lens.pinhole();
  return {p.width_px,
          p.height_px,
          p.focal_px,
          p.centre_u_px,
          p.centre_v_px,
          {lens.radial()[0], lens.radial()[1], lens.radial()[2]},
          {lens.tangential()[0], lens.tangential()[1]}};
}

Status SimulatedStage::show(std::size_t projector, const RgbImage& picture) {
  const std::lock_guard lock(state_->mutex);
  if (projector >= state_->pictures.size())
    return Error(ErrorCode::kInvalidArgument, fmt::format("there is no projector {}", projector));
  const Pinhole& lens = state_->show.truth().truth().projectors[projector].lens.pinhole();
  const int factor = picture.empty() ? 1 : std::max(1, lens.width_px / picture.width());
  // A picture of another shape is refused below.
  const bool is_smaller =
      factor > 1 && picture.width() == lens.width_px / factor && picture.height() == lens.height_px / factor;
  RgbImage shown = is_smaller ? enlarged(picture, factor, lens.width_px, lens.height_px) : picture;
  TRY(state_->show.show(projector, shown));
  state_->pictures[projector] = std::move(shown);
  return Done{};
}

Result<GreyImage> SimulatedStage::photograph(std::size_t camera, double exposure_s) {
  const std::lock_guard lock(state_->mutex);
  TRY(state_->take_bumps());
  return state_->show.photograph(camera, exposure_s);
}

}  // namespace cyclorama::simulated
