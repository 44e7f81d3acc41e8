// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/simulated_camera.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace cyclorama::simulated {
namespace {

/// Adds furniture: rectangles of any grey, some of them dark quads on a light background, as tags are, to challenge a
/// detector.
void add_clutter(std::uint32_t seed, Image<float, 1>* ret_picture) {
  std::mt19937 random(seed);
  const auto uniform = [&](int below) {
    return static_cast<int>(random() % static_cast<unsigned>(std::max(below, 1)));
  };
  const int width = ret_picture->width();
  const int height = ret_picture->height();
  for (int i = 0; i < 60; ++i) {
    const int left = uniform(width);
    const int top = uniform(height);
    const int right = std::min(width, left + 4 + uniform(width / 6));
    const int bottom = std::min(height, top + 4 + uniform(height / 6));
    const auto grey = static_cast<float>(20 + uniform(200));
    for (int y = top; y < bottom; ++y)
      std::fill(ret_picture->at(left, y), ret_picture->at(left, y) + (right - left), grey);
  }
}

Image<float, 1> make_backdrop(const Simulation& simulation) {
  const auto grey = static_cast<float>(simulation.backdrop_grey);
  Image<float, 1> picture(simulation.lens.width_px, simulation.lens.height_px, grey);
  if (simulation.backdrop == Backdrop::kPlain) return picture;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      // Light from a window at the upper left: factors from 1.3 to 0.5.
      const float across = static_cast<float>(x) / static_cast<float>(picture.width());
      const float down = static_cast<float>(y) / static_cast<float>(picture.height());
      *picture.at(x, y) = grey * (1.3f - 0.5f * across - 0.3f * down);
    }
  }
  if (simulation.backdrop == Backdrop::kClutter) add_clutter(simulation.seed, &picture);
  return picture;
}

}  // namespace

SimulatedView::SimulatedView(Simulation simulation)
    : simulation_(std::move(simulation)),
      painter_(simulation_.wand),
      backdrop_(make_backdrop(simulation_)),
      sensor_(simulation_.noise_grey, simulation_.seed) {}

GreyImage SimulatedView::picture(std::uint64_t sequence) const {
  Image<float, 1> light = backdrop_;
  const double opens_s = static_cast<double>(sequence) / simulation_.frames_per_second;
  std::vector<RigidTransform<frame::Camera, frame::Tag>> poses;
  for (int step = 0; step < simulation_.exposure_steps; ++step) {
    poses.push_back(simulation_.path.at(opens_s + simulation_.exposure_s * (step + 0.5) / simulation_.exposure_steps));
  }
  painter_.paint(poses, simulation_.lens, &light);

  return sensor_.expose(light, simulation_.brightness, sequence);
}

SimulatedCamera::SimulatedCamera(Simulation simulation, const Clock& clock)
    : view_(std::move(simulation)), clock_(clock) {
  exposure_ = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(view_.simulation().exposure_s));
  pace_.period = camera::period_of(view_.simulation().frames_per_second);
}

Status SimulatedCamera::start() {
  pace_.first_at = clock_.now() + exposure_;
  last_.reset();
  streaming_ = true;
  return Done{};
}

Result<std::shared_ptr<const camera::CameraFrame>> SimulatedCamera::next_frame(TimePoint deadline) {
  if (!streaming_) return Error(ErrorCode::kUnavailable, "the simulated camera was not started");
  TRY_ASSIGN(const std::uint64_t sequence, camera::wait_for_picture(pace_, last_, clock_, deadline));
  last_ = sequence;
  auto frame = std::make_shared<camera::CameraFrame>();
  frame->pixels = view_.picture(sequence);
  frame->sequence = sequence;
  frame->captured_at = pace_.ready_at(sequence) - exposure_;
  return std::shared_ptr<const camera::CameraFrame>(std::move(frame));
}

}  // namespace cyclorama::simulated
