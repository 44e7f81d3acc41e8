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
  mutable std::mutex mutex_;
  std::vector<wire::SteerRequest> steered_;
  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
