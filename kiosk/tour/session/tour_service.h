// SPDX-License-Identifier: Apache-2.0
/// The tour's side of wire::Tour: validates messages and passes them on; has no thread of its own.
#pragma once

#include <atomic>

#include "common/wire/museum.grpc.pb.h"
#include "kiosk/tour/session/display_hub.h"
#include "kiosk/tour/session/stop_requests.h"
#include "kiosk/tour/session/tour_events.h"

namespace cyclorama::tour {

/// Borrows all arguments, which must outlive the WireServer that it is registered with. Thread-safe.
///
/// Streams are gRPC reactors: a display that stops reading costs only the memory of its outbox.
class TourService final : public wire::Tour::CallbackService {
 public:
  TourService(DisplayHub* displays, TourEvents* events, StopRequests* stops)
      : displays_(*displays), events_(*events), stops_(*stops) {}

 private:
  grpc::ServerBidiReactor<wire::DisplayReport, wire::ShowMessage>* Show(grpc::CallbackServerContext* context) override;
  grpc::ServerReadReactor<wire::TrackedPose>* Track(grpc::CallbackServerContext* context,
                                                    wire::TrackReply* reply) override;
  grpc::ServerUnaryReactor* Steer(grpc::CallbackServerContext* context, const wire::SteerRequest* request,
                                  wire::SteerReply* reply) override;
  grpc::ServerUnaryReactor* ListStops(grpc::CallbackServerContext* context, const wire::ListStopsRequest* request,
                                      wire::StopList* reply) override;
  grpc::ServerUnaryReactor* GoToStop(grpc::CallbackServerContext* context, const wire::GoToStopRequest* request,
                                     wire::GoToStopReply* reply) override;
  grpc::ServerUnaryReactor* AddStop(grpc::CallbackServerContext* context, const wire::AddStopRequest* request,
                                    wire::AddStopReply* reply) override;
  grpc::ServerUnaryReactor* UndoStop(grpc::CallbackServerContext* context, const wire::UndoStopRequest* request,
                                     wire::UndoStopReply* reply) override;
  grpc::ServerUnaryReactor* SetLamps(grpc::CallbackServerContext* context, const wire::SetLampsRequest* request,
                                     wire::SetLampsReply* reply) override;
  grpc::ServerUnaryReactor* FetchPictures(grpc::CallbackServerContext* context,
                                          const wire::FetchPicturesRequest* request,
                                          wire::FetchPicturesReply* reply) override;
  grpc::ServerUnaryReactor* SetCaptions(grpc::CallbackServerContext* context, const wire::SetCaptionsRequest* request,
                                        wire::SetCaptionsReply* reply) override;

  DisplayHub& displays_;
  TourEvents& events_;
  StopRequests& stops_;
  std::atomic<std::uint64_t> shows_{0};
  std::atomic<std::uint64_t> trackers_{0};
};

}  // namespace cyclorama::tour
