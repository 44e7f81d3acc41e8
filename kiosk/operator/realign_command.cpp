// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/realign_command.h"

#include <grpcpp/client_context.h>

#include <cstdio>

#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::operations {
namespace {
constexpr auto kRequestTimeout = std::chrono::seconds(5);
constexpr auto kToPlace = std::chrono::minutes(20);
}  // namespace

void RealignCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "realign", "Align every projector anew while the show goes on, and correct even small displacements");
  command.add_flag("--place-cameras", places_cameras,
                   "Locate the fixed cameras instead: the heads show patterns for a minute or two");
  command
      .add_flag("--undo", undoes,
                "Undo the last correction instead: its projector counts as correctly placed where it is now")
      ->excludes("--place-cameras");
  command.add_option("--calibrator", calibrator, "Address of cyclorama-calibrator")
      ->type_name("HOST:PORT")
      ->capture_default_str();
}

Status RealignCommand::run() const {
  TRY_ASSIGN(const std::shared_ptr<grpc::Channel> channel, make_channel(calibrator));
  const auto stub = wire::Healing::NewStub(channel);
  grpc::ClientContext context;
  if (!places_cameras) {
    context.set_deadline(std::chrono::system_clock::now() + kRequestTimeout);
    wire::RealignRequest order;
    order.set_undo(undoes);
    wire::RealignReply answer;
    const grpc::Status status = stub->Realign(&context, order, &answer);
    if (!status.ok()) return from_grpc(status, undoes ? "undoing the last correction" : "realigning");
    std::puts(undoes ? printable(answer.undone()).c_str()
                     : "the projectors are being realigned; 'cyclorama status' shows the result");
    return Done{};
  }
  context.set_deadline(std::chrono::system_clock::now() + kToPlace);
  wire::PlacedCameras placed;
  const grpc::Status status = stub->PlaceCameras(&context, wire::PlaceCamerasRequest(), &placed);
  if (!status.ok()) return from_grpc(status, "locating the cameras");
  for (const wire::PlacedCameras::Camera& camera : placed.cameras()) {
    if (!camera.trouble().empty()) {
      std::printf("not placed: %s\n", printable(camera.trouble()).c_str());
      continue;
    }
    std::printf("camera %s: %u correspondences, off by %.2f px\n", printable(camera.name()).c_str(), camera.places(),
                camera.rms_px());
  }
  return Done{};
}

}  // namespace cyclorama::operations
