// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/realign_command.h"

#include <grpcpp/client_context.h>

#include <cstdio>

#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama {
namespace {
constexpr auto kToTell = std::chrono::seconds(5);
constexpr auto kToPlace = std::chrono::minutes(20);
}  // namespace

void RealignCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "realign", "Look for every projector anew while the show goes on, and correct what is found, however little");
  command.add_flag("--place-cameras", places_cameras,
                   "Find out where the fixed cameras stand instead: the heads show patterns for a minute or two");
  command
      .add_flag("--undo", undoes,
                "Take the last correction back instead: how its projector is seen now counts as its place")
      ->excludes("--place-cameras");
  command.add_option("--calibrator", calibrator, "Where cyclorama-calibrator listens")
      ->type_name("HOST:PORT")
      ->capture_default_str();
}

Status RealignCommand::run() const {
  TRY_ASSIGN(const std::shared_ptr<grpc::Channel> channel, make_channel(calibrator));
  const auto stub = wire::Healing::NewStub(channel);
  grpc::ClientContext context;
  if (!places_cameras) {
    context.set_deadline(std::chrono::system_clock::now() + kToTell);
    wire::RealignOrder order;
    order.set_undo(undoes);
    wire::RealignAnswer answer;
    const grpc::Status status = stub->Realign(&context, order, &answer);
    if (!status.ok()) return from_grpc(status, undoes ? "taking the last correction back" : "realigning");
    std::puts(undoes ? printable(answer.undone()).c_str()
                     : "the projectors are looked for anew; cyclorama status tells what comes of it");
    return Done{};
  }
  context.set_deadline(std::chrono::system_clock::now() + kToPlace);
  wire::PlacedCameras placed;
  const grpc::Status status = stub->PlaceCameras(&context, wire::PlaceCamerasOrder(), &placed);
  if (!status.ok()) return from_grpc(status, "placing the cameras");
  for (const wire::PlacedCameras::Camera& camera : placed.cameras()) {
    if (!camera.trouble().empty()) {
      std::printf("not placed: %s\n", printable(camera.trouble()).c_str());
      continue;
    }
    std::printf("camera %s: %u places, off by %.2f px\n", printable(camera.name()).c_str(), camera.places(),
                camera.rms_px());
  }
  return Done{};
}

}  // namespace cyclorama
