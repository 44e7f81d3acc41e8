// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/healing_service.h"

#include "common/wire/channel.h"

namespace cyclorama::healing {
namespace {
grpc::Status refused(const std::string& why) { return {grpc::StatusCode::FAILED_PRECONDITION, why}; }
}  // namespace

grpc::Status HealingService::PlaceCameras(grpc::ServerContext* context, const wire::PlaceCamerasRequest*,
                                          wire::PlacedCameras* reply) {
  if (loop_ == nullptr) return {grpc::StatusCode::NOT_FOUND, kNoCameraWatches};
  const std::unique_lock working(busy_, std::try_to_lock);
  if (!working) return refused("the cameras are being placed already");
  std::stop_source stop;
  const std::stop_callback process_stops(stop_.get_token(), [&] { stop.request_stop(); });
  // Cancels the placement if the client disconnects.
  std::jthread watch([&](const std::stop_token& over) {
    while (!over.stop_requested()) {
      if (context->IsCancelled()) stop.request_stop();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  const auto held = loop_->hold();
  const auto placed = loop_->place_cameras(stop.get_token());
  if (!placed) return to_grpc(placed.error());
  for (const PlacedCamera& camera : *placed) {
    wire::PlacedCameras::Camera* const one = reply->add_cameras();
    one->set_name(camera.name);
    one->set_places(static_cast<std::uint32_t>(camera.correspondences));
    one->set_rms_px(camera.rms_px);
    one->set_trouble(camera.trouble);
  }
  return grpc::Status::OK;
}

grpc::Status HealingService::Realign(grpc::ServerContext*, const wire::RealignRequest* order,
                                     wire::RealignReply* answer) {
  if (loop_ == nullptr)
    return refused("nothing watches the wall; name a fixed camera in calibrator.toml, or with --watch");
  if (order->undo()) {
    const auto undone = loop_->undo();
    if (!undone && undone.error().code() == ErrorCode::kNotFound) return to_grpc(undone.error());
    if (!undone) return refused(undone.error().message());
    answer->set_undone(*undone);
    return grpc::Status::OK;
  }
  if (const Status told = loop_->realign(); !told) return refused(told.error().message());
  return grpc::Status::OK;
}

}  // namespace cyclorama::healing
