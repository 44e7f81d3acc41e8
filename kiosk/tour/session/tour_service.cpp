// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/tour_service.h"

#include <fmt/format.h>

#include <cmath>

#include "common/base/clock.h"
#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/convert.h"

namespace cyclorama::tour {
namespace {

grpc::Status invalid(const std::string& message) { return {grpc::StatusCode::INVALID_ARGUMENT, message}; }

SharedShowMessage stamped(const wire::ClockReply& answer) {
  auto message = std::make_shared<wire::ShowMessage>();
  *message->mutable_clock() = answer;
  message->mutable_clock()->set_system_ns(std::chrono::system_clock::now().time_since_epoch().count());
  message->mutable_clock()->set_answered_ns(to_nanoseconds(SteadyClock().now()));
  return message;
}

/// Returns nothing known for numbers that no projector has.
PixelDensity density_of(const wire::DisplayHello& hello) {
  constexpr double kMax = 1e5;
  const double min = hello.min_px_per_rad();
  const double max = hello.max_px_per_rad();
  if (!(min >= 1.0 && min <= max && max <= kMax)) return {};
  return {min, max};
}

/// A Show stream. Owns itself until gRPC is done with it; the hub shares it while the display is a member.
///
///   created ──hello──► member of the hub ──(cancelled, half-closed, wrong message, closed)──► finished
///   finished ──OnDone──► gone
///
/// Lock order: the hub's lock before the call's; therefore no function here calls the hub while it holds the call's
/// lock.
class ShowCall final : public grpc::ServerBidiReactor<wire::DisplayReport, wire::ShowMessage>, public DisplayLink {
 public:
  static ShowCall* start(std::uint64_t number, DisplayHub* displays, TourEvents* events) {
    const auto call = std::make_shared<ShowCall>(number, displays, events);
    call->self_ = call;
    call->StartRead(&call->report_);
    return call.get();
  }
  ShowCall(std::uint64_t number, DisplayHub* displays, TourEvents* events)
      : number_(number), displays_(*displays), events_(*events) {}

  void send_heading(const wire::Heading& heading, const wire::ShowAt* show_at) override {
    const std::lock_guard lock(mutex_);
    if (!outbox_) return;
    outbox_->put_heading(heading, show_at);
    write_next();
  }
  std::optional<std::uint64_t> send(const SharedShowMessage& message) override {
    const std::lock_guard lock(mutex_);
    if (!outbox_) return std::nullopt;
    const auto lost = outbox_->put(message);
    write_next();
    return lost;
  }
  void send_caption(const SharedShowMessage& caption) override {
    const std::lock_guard lock(mutex_);
    if (!outbox_) return;
    outbox_->put_caption(caption);
    write_next();
  }
  void close(const Error& reason) override { finish(to_grpc(reason)); }

 private:
  void OnReadDone(bool ok) override {
    const TimePoint now = SteadyClock().now();
    if (!ok) return finish(grpc::Status::OK);
    if (const grpc::Status status = handle_report(now); !status.ok()) return finish(status);
    const std::lock_guard lock(mutex_);
    if (!finished_) StartRead(&report_);
  }
  void OnWriteDone(bool ok) override {
    if (!ok) return finish({grpc::StatusCode::UNAVAILABLE, "the display went away"});
    const std::lock_guard lock(mutex_);
    writing_ = nullptr;
    write_next();
  }
  void OnCancel() override { finish({grpc::StatusCode::CANCELLED, "cancelled"}); }
  void OnDone() override {
    displays_.leave(this);
    if (member_) events_.on_display_left(number_);
    self_.reset();  // Must be last: it may destroy this object.
  }

  grpc::Status handle_report(TimePoint now) {
    if (report_.has_hello() == member_) return invalid("hello must come first, and once");
    switch (report_.message_case()) {
      case wire::DisplayReport::kHello:
        return handle_hello(report_.hello());
      case wire::DisplayReport::kPresented:
        events_.on_presented(number_, report_.presented());
        break;
      case wire::DisplayReport::kDropped:
        events_.on_dropped(number_, report_.dropped());
        break;
      case wire::DisplayReport::kClock:
        answer(report_.clock(), now);
        events_.on_clock_question(number_, report_.clock());
        break;
      case wire::DisplayReport::MESSAGE_NOT_SET:
        return invalid("a report without a message");
    }
    return grpc::Status::OK;
  }
  void answer(const wire::ClockRequest& question, TimePoint now) {
    wire::ClockReply times;
    times.set_asked_ns(question.asked_ns());
    times.set_received_ns(to_nanoseconds(now));
    const std::lock_guard lock(mutex_);
    if (!outbox_) return;
    outbox_->put_answer(times);
    write_next();
  }
  grpc::Status handle_hello(const wire::DisplayHello& hello) {
    const auto wanted = from_wire(hello.wanted());
    if (!wanted) return invalid("hello.wanted: " + wanted.error().message());
    {
      const std::lock_guard lock(mutex_);
      if (finished_) return grpc::Status::OK;
      outbox_.emplace(hello.wanted());
    }
    if (const Status joined = displays_.join(self_, printable(hello.name()), *wanted, density_of(hello)); !joined) {
      return to_grpc(joined.error());
    }
    member_ = true;
    events_.on_display_joined(number_, hello);
    return grpc::Status::OK;
  }
  /// Writes the next message, if no write is in progress. Requires the lock.
  void write_next() {
    if (finished_ || writing_ != nullptr) return;
    const auto times = outbox_->take_answer();
    writing_ = times ? stamped(*times) : outbox_->take();
    if (writing_ != nullptr) StartWrite(writing_.get());
  }
  void finish(const grpc::Status& status) {
    const std::lock_guard lock(mutex_);
    if (std::exchange(finished_, true)) return;
    outbox_.reset();  // `writing_` stays, since gRPC may still read it.
    Finish(status);
  }

  const std::uint64_t number_;
  DisplayHub& displays_;
  TourEvents& events_;
  wire::DisplayReport report_;
  bool member_ = false;  ///< Used by reads and OnDone only, which gRPC never runs concurrently.
  std::shared_ptr<ShowCall> self_;
  std::mutex mutex_;  ///< Guards the following.
  std::optional<Outbox> outbox_;
  SharedShowMessage writing_;
  bool finished_ = false;
};

class TrackCall final : public grpc::ServerReadReactor<wire::TrackedPose> {
 public:
  TrackCall(std::uint64_t tracker, TourEvents* events) : tracker_(tracker), events_(*events) {
    events_.on_tracker_joined(tracker_);
    StartRead(&pose_);
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::OK);  // The stream was closed or cancelled.
    events_.on_pose(tracker_, pose_);
    StartRead(&pose_);
  }
  void OnDone() override {
    events_.on_tracker_left(tracker_);
    delete this;
  }
  const std::uint64_t tracker_;
  TourEvents& events_;
  wire::TrackedPose pose_;
};

Result<SteeringCommand> command_of(const wire::SteerRequest& request) {
  const SteeringCommand command{request.forward(), request.right(), request.turn()};
  for (const auto& [name, value] :
       {std::pair{"forward", command.forward}, {"right", command.right}, {"turn", command.turn}}) {
    if (!(std::abs(value) <= 1.0)) {
      return Error(ErrorCode::kInvalidArgument, fmt::format("steer.{} is {}; it must be -1 to 1", name, value));
    }
  }
  return command;
}

template <typename Reply>
grpc::ServerUnaryReactor* answered(grpc::CallbackServerContext* context, Result<Reply> answer, Reply* ret_reply) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const grpc::Status status = answer ? grpc::Status::OK : to_grpc(answer.error());
  if (answer) *ret_reply = *std::move(answer);
  reactor->Finish(status);
  return reactor;
}

}  // namespace

grpc::ServerBidiReactor<wire::DisplayReport, wire::ShowMessage>* TourService::Show(grpc::CallbackServerContext*) {
  return ShowCall::start(++shows_, &displays_, &events_);
}

grpc::ServerReadReactor<wire::TrackedPose>* TourService::Track(grpc::CallbackServerContext*, wire::TrackReply*) {
  return new TrackCall(++trackers_, &events_);  // Deletes itself in OnDone(), as gRPC requires.
}

grpc::ServerUnaryReactor* TourService::Steer(grpc::CallbackServerContext* context, const wire::SteerRequest* request,
                                             wire::SteerReply*) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const auto command = command_of(*request);
  if (command) events_.on_keys(*command);
  reactor->Finish(command ? grpc::Status::OK : to_grpc(command.error()));
  return reactor;
}

grpc::ServerUnaryReactor* TourService::ListStops(grpc::CallbackServerContext* context, const wire::ListStopsRequest*,
                                                 wire::StopList* reply) {
  return answered(context, stops_.list_stops(), reply);
}

grpc::ServerUnaryReactor* TourService::GoToStop(grpc::CallbackServerContext* context,
                                                const wire::GoToStopRequest* request, wire::GoToStopReply* reply) {
  return answered(context, stops_.go_to_stop(*request), reply);
}

grpc::ServerUnaryReactor* TourService::AddStop(grpc::CallbackServerContext* context,
                                               const wire::AddStopRequest* request, wire::AddStopReply* reply) {
  return answered(context, stops_.add_stop(*request), reply);
}

grpc::ServerUnaryReactor* TourService::UndoStop(grpc::CallbackServerContext* context, const wire::UndoStopRequest*,
                                                wire::UndoStopReply* reply) {
  return answered(context, stops_.undo_stop(), reply);
}

grpc::ServerUnaryReactor* TourService::SetLamps(grpc::CallbackServerContext* context,
                                                const wire::SetLampsRequest* request, wire::SetLampsReply* reply) {
  return answered(context, stops_.set_lamps(*request), reply);
}

grpc::ServerUnaryReactor* TourService::FetchPictures(grpc::CallbackServerContext* context,
                                                     const wire::FetchPicturesRequest*,
                                                     wire::FetchPicturesReply* reply) {
  return answered(context, stops_.fetch_pictures(), reply);
}

grpc::ServerUnaryReactor* TourService::SetCaptions(grpc::CallbackServerContext* context,
                                                   const wire::SetCaptionsRequest* request,
                                                   wire::SetCaptionsReply* reply) {
  return answered(context, stops_.set_captions(*request), reply);
}

}  // namespace cyclorama::tour
