// SPDX-License-Identifier: Apache-2.0
/// A process that has only an InspectionService on [::1] and a Tour that records steering.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama {

/// Returns a distinguishable picture: a ramp, shifted by `shift_px`.
inline std::shared_ptr<const RgbImage> ramp_picture(int shift_px, int width = 64, int height = 32) {
  auto picture = std::make_shared<RgbImage>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int level = 4 * ((x + shift_px) % 60);
      for (int c = 0; c < 3; ++c) picture->at(x, y)[c] = static_cast<std::uint8_t>(level);
    }
  }
  return picture;
}

/// Listens on [::1] from its construction. Thread-safe.
class FakeProcess final : public wire::Tour::Service {
 public:
  explicit FakeProcess(const std::string& name, int port = 0) : inspection(name) {
    auto server = WireServer::start("[::1]:" + std::to_string(port), {this, &inspection});
    CHECK(server);
    server_ = *std::move(server);
    inspection.set_state("All is well with " + name + ".", true);
  }
  ~FakeProcess() override { server_->stop(Duration::zero()); }
  FakeProcess(const FakeProcess&) = delete;
  FakeProcess& operator=(const FakeProcess&) = delete;

  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }
  [[nodiscard]] int port() const { return server_->port(); }
  /// Requests for stops, as text: "+1", "-1", or a name.
  [[nodiscard]] std::vector<std::string> gone_to() const {
    const std::lock_guard lock(mutex_);
    return gone_to_;
  }
  [[nodiscard]] std::vector<wire::SteerRequest> steered() const {
    const std::lock_guard lock(mutex_);
    return steered_;
  }

  InspectionService inspection;

 private:
  grpc::Status Steer(grpc::ServerContext*, const wire::SteerRequest* request, wire::SteerReply*) override {
    const std::lock_guard lock(mutex_);
    steered_.push_back(*request);
    return grpc::Status::OK;
  }
  grpc::Status ListStops(grpc::ServerContext*, const wire::ListStopsRequest*, wire::StopList* reply) override {
    reply->set_tour_title("A tour");
    reply->add_languages("de");
    reply->set_at(0);
    wire::StopSummary* const stop = reply->add_stops();
    stop->set_name("well");
    (*stop->mutable_titles())["de"] = "Brunnen";
    (*stop->mutable_titles())["en"] = "Well";
    return grpc::Status::OK;
  }
  grpc::Status GoToStop(grpc::ServerContext*, const wire::GoToStopRequest* request,
                        wire::GoToStopReply* reply) override {
    const std::lock_guard lock(mutex_);
    gone_to_.push_back(request->has_name() ? request->name() : request->step() > 0 ? "+1" : "-1");
    if (request->name() == "cellar") return {grpc::StatusCode::NOT_FOUND, "no stop has this name"};
    reply->set_name("well");
    return grpc::Status::OK;
  }
  grpc::Status UndoStop(grpc::ServerContext*, const wire::UndoStopRequest*, wire::UndoStopReply*) override {
    return grpc::Status::OK;
  }
  mutable std::mutex mutex_;
  std::vector<wire::SteerRequest> steered_;
  std::vector<std::string> gone_to_;
  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
