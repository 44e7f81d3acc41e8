// SPDX-License-Identifier: Apache-2.0
/// A tracker without a camera: connects to the tour and reports what the test sets.
#pragma once

#include <grpcpp/client_context.h>

#include <cmath>
#include <memory>
#include <string>

#include "common/base/clock.h"
#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama {

/// Connected from its construction. Thread-bound.
class FakeTracker {
 public:
  explicit FakeTracker(const std::string& tour) {
    auto channel = make_channel(tour);
    CHECK(channel);
    stub_ = wire::Tour::NewStub(*channel);
    writer_ = stub_->Track(&context_, &reply_);
  }
  ~FakeTracker() {
    writer_->WritesDone();
    context_.TryCancel();
    static_cast<void>(writer_->Finish());
  }
  FakeTracker(const FakeTracker&) = delete;
  FakeTracker& operator=(const FakeTracker&) = delete;

  /// Reports a centred tag at a distance of `distance_m` from the camera, turned by `yaw_rad` to the visitor's right.
  bool see(double distance_m, double yaw_rad) {
    wire::TrackedPose pose = picture();
    pose.set_found(true);
    pose.mutable_position_m()->set_z(distance_m);
    pose.set_rotation_w(std::cos(yaw_rad / 2));
    pose.set_rotation_y(std::sin(yaw_rad / 2));
    return writer_->Write(pose);
  }
  bool see_nothing() { return writer_->Write(picture()); }
  bool send(const wire::TrackedPose& pose) { return writer_->Write(pose); }
  wire::TrackedPose picture() {
    wire::TrackedPose pose;
    pose.set_camera("fake");
    pose.set_sequence(++sequence_);
    pose.set_shutter_ns(to_nanoseconds(SteadyClock().now()));
    for (const char* const name : {"capture", "detect", "pose"}) {
      wire::StageTime* const stage = pose.add_stages();
      stage->set_name(name);
      stage->set_seconds(3e-3);
    }
    return pose;
  }

 private:
  grpc::ClientContext context_;
  wire::TrackReply reply_;
  std::unique_ptr<wire::Tour::Stub> stub_;
  std::unique_ptr<grpc::ClientWriter<wire::TrackedPose>> writer_;
  std::uint64_t sequence_ = 0;
};

}  // namespace cyclorama
