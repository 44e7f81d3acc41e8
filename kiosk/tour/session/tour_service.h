// SPDX-License-Identifier: Apache-2.0
/// The tour's side of wire::Tour: validates messages and passes them on; has no thread of its own.
#pragma once

#include <atomic>

#include "common/wire/museum.grpc.pb.h"
#include "kiosk/tour/session/display_hub.h"
#include "kiosk/tour/session/tour_events.h"

namespace cyclorama::tour {

/// Borrows both arguments, which must outlive the WireServer that it is registered with. Thread-safe.
///
/// Streams are gRPC reactors: a display that stops reading costs only the memory of its outbox.
class TourService final : public wire::Tour::CallbackService {
 public:
  TourService(DisplayHub* displays, TourEvents* events) : displays_(*displays), events_(*events) {}

 private:
  grpc::ServerBidiReactor<wire::DisplayReport, wire::ShowMessage>* Show(grpc::CallbackServerContext* context) override;
  grpc::ServerReadReactor<wire::TrackedPose>* Track(grpc::CallbackServerContext* context,
                                                    wire::TrackReply* reply) override;
  grpc::ServerUnaryReactor* Steer(grpc::CallbackServerContext* context, const wire::SteerRequest* request,
                                  wire::SteerReply* reply) override;
  DisplayHub& displays_;
  TourEvents& events_;
  std::atomic<std::uint64_t> shows_{0};
  std::atomic<std::uint64_t> trackers_{0};
};

}  // namespace cyclorama::tour
