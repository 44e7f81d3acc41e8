// SPDX-License-Identifier: Apache-2.0
/// A tour that sends a test's messages to displays.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama {

/// Listens on [::1] from start(). Accepts one display at a time. Thread-safe.
class FakeTour final : private wire::Tour::Service {
 public:
  static std::unique_ptr<FakeTour> start(const std::string& address = "[::1]:0") {
    std::unique_ptr<FakeTour> tour(new FakeTour);
    auto server = WireServer::start(address, {static_cast<wire::Tour::Service*>(tour.get())});
    CHECK(server.has_value());
    tour->server_ = *std::move(server);
    return tour;
  }
  ~FakeTour() override {
    hang_up();
    server_->stop(std::chrono::seconds(5));
  }
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }

  /// Waits for a display that has sent its hello.
  bool wait_for_display() {
    return wait_until([this] { return stream_ != nullptr && has_hello_; });
  }
  /// Sends a message to the connected display. Returns false if there is none.
  bool send(const wire::ShowMessage& message) {
    const std::lock_guard lock(mutex_);
    return stream_ != nullptr && stream_->Write(message);
  }
  void send_all(const std::vector<wire::ShowMessage>& messages) {
    for (const wire::ShowMessage& message : messages) send(message);
  }
  void send_heading(double heading_rad, std::int64_t shutter_ns) {
    wire::ShowMessage message;
    message.mutable_heading()->set_heading_rad(heading_rad);
    message.mutable_heading()->set_shutter_ns(shutter_ns);
    send(message);
  }
  /// Ends the display's stream; the display may connect again.
  void hang_up() {
    std::unique_lock lock(mutex_);
    if (context_ == nullptr) return;
    context_->TryCancel();
    changed_.wait_for(lock, std::chrono::seconds(20), [this] { return stream_ == nullptr; });
  }
  bool wait_for_reports(std::size_t frames_presented, std::size_t frames_dropped) {
    return wait_until([&] { return presented.size() >= frames_presented && dropped.size() >= frames_dropped; });
  }

  bool has_question(const std::function<bool(const wire::ClockRequest&)>& condition) {
    const std::lock_guard lock(mutex_);
    return std::any_of(questions.begin(), questions.end(), condition);
  }
  bool wait_for_questions(std::size_t count) {
    return wait_until([&] { return questions.size() >= count; });
  }
  /// Returns the tour's time, which is one hour ahead of the machine's.
  static std::int64_t now_ns() { return to_nanoseconds(SteadyClock().now() + std::chrono::hours(1)); }

  // Read only after a wait that excludes further messages.
  wire::DisplayHello hello;
  int displays = 0;
  std::vector<wire::FramePresented> presented;
  std::vector<wire::FrameDropped> dropped;
  std::vector<wire::ClockRequest> questions;  ///< Read only while no display is connected, because more keep arriving.

 private:
  using Stream = grpc::ServerReaderWriter<wire::ShowMessage, wire::DisplayReport>;
  FakeTour() = default;

  bool wait_until(const std::function<bool()>& condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), condition);
  }
  grpc::Status Show(grpc::ServerContext* context, Stream* stream) override {
    {
      const std::lock_guard lock(mutex_);
      context_ = context;
      stream_ = stream;
      has_hello_ = false;
      ++displays;
    }
    wire::DisplayReport report;
    while (stream->Read(&report)) {
      const std::lock_guard lock(mutex_);
      if (report.has_hello()) {
        hello = report.hello();
        has_hello_ = true;
      }
      if (report.has_presented()) presented.push_back(report.presented());
      if (report.has_dropped()) dropped.push_back(report.dropped());
      if (report.has_clock()) {
        questions.push_back(report.clock());
        wire::ShowMessage message;
        wire::ClockReply* const answer = message.mutable_clock();
        answer->set_asked_ns(report.clock().asked_ns());
        answer->set_received_ns(now_ns());
        answer->set_answered_ns(now_ns());
        answer->set_system_ns(std::chrono::system_clock::now().time_since_epoch().count());
        stream->Write(message);
      }
      changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    if (stream_ == stream) {  // The display may have reconnected before the end of this stream was noticed.
      context_ = nullptr;
      stream_ = nullptr;
    }
    changed_.notify_all();
    return grpc::Status::OK;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  grpc::ServerContext* context_ = nullptr;
  Stream* stream_ = nullptr;
  bool has_hello_ = false;
  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
