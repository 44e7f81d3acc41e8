// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tour_link.h"

#include <grpcpp/client_context.h>
#include <pthread.h>

#include <algorithm>
#include <utility>

#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama::tracker {
namespace {

/// Maximum delay until a request to stop, or a closed connection, is noticed.
constexpr std::chrono::milliseconds kLookAround(200);
constexpr Duration kFirstPause = std::chrono::milliseconds(100);
constexpr Duration kMaxPause = std::chrono::seconds(2);
/// After a stream that lasted longer than this, the pause is short again.
constexpr Duration kGoodStream = std::chrono::seconds(5);

PoseReport report_of(const wire::TrackedPose& pose) {
  PoseReport report;
  report.sensor = static_cast<std::int32_t>(pose.tag());
  report.sequence = pose.sequence();
  report.time_ns = pose.shutter_ns();
  report.found = pose.found();
  if (!report.found) return report;
  report.position_m = {pose.position_m().x(), pose.position_m().y(), pose.position_m().z()};
  report.rotation = {pose.rotation_w(), pose.rotation_x(), pose.rotation_y(), pose.rotation_z()};
  return report;
}

}  // namespace

Result<std::unique_ptr<TourLink>> TourLink::open(const std::string& address) {
  TRY_ASSIGN(std::shared_ptr<grpc::Channel> channel, make_channel(address));
  return std::unique_ptr<TourLink>(new TourLink(std::move(channel)));
}

TourLink::TourLink(std::shared_ptr<grpc::Channel> channel)
    : channel_(std::move(channel)), thread_([this](const std::stop_token& stop) {
        pthread_setname_np(pthread_self(), "link");
        run(stop);
      }) {}

TourLink::~TourLink() {
  thread_.request_stop();
  outbox_.close();
  {
    const std::lock_guard lock(mutex_);
    if (context_ != nullptr) context_->TryCancel();
  }
  thread_.join();
}

void TourLink::send(wire::TrackedPose pose) {
  if (pose_sender_) pose_sender_->say(report_of(pose));
  outbox_.put(std::move(pose));
}

void TourLink::run(const std::stop_token& stop) {
  const SteadyClock clock;
  Duration pause = kFirstPause;
  while (!stop.stop_requested()) {
    // The channel connects by itself, with its own back-off; gRPC's deadlines are on the system clock.
    if (!channel_->WaitForConnected(std::chrono::system_clock::now() + kLookAround)) continue;
    const TimePoint began = clock.now();
    stream(stop);
    if (clock.now() - began > kGoodStream) pause = kFirstPause;
    // The tour ended the stream, perhaps because it is starting. Poses in the outbox become stale in the meantime.
    const TimePoint until = clock.now() + pause;
    while (clock.now() < until && !outbox_.is_closed()) static_cast<void>(outbox_.take_before(until));
    pause = std::min(2 * pause, kMaxPause);
  }
}

void TourLink::stream(const std::stop_token& stop) {
  grpc::ClientContext context;
  {
    const std::lock_guard lock(mutex_);
    if (stop.stop_requested()) return;
    context_ = &context;
  }
  wire::TrackReply reply;
  const std::unique_ptr<wire::Tour::Stub> stub = wire::Tour::NewStub(channel_);
  const auto writer = stub->Track(&context, &reply);
  connected_ = true;
  while (!stop.stop_requested() && channel_->GetState(false) == GRPC_CHANNEL_READY) {
    const auto pose = outbox_.take_before(SteadyClock().now() + kLookAround);
    if (!pose) continue;
    if (!writer->Write(*pose)) break;
    ++sent_;
  }
  connected_ = false;
  context.TryCancel();  // Without it, Finish() would wait for a tour that may never answer.
  static_cast<void>(writer->Finish());
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
}

}  // namespace cyclorama::tracker
