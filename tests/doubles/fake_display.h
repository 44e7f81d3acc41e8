// SPDX-License-Identifier: Apache-2.0
/// A display without heads: connects to the tour, records the messages, and can be slow.
#pragma once

#include <grpcpp/client_context.h>

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/channel.h"
#include "common/wire/convert.h"
#include "common/wire/museum.grpc.pb.h"
#include "common/wire/payload.h"

namespace cyclorama {

inline Panorama fake_wall(int width_px = 320) { return {width_px, width_px / 2, 2.0, 0.5, -0.5}; }

/// Connected from its construction. Thread-safe.
class FakeDisplay {
 public:
  struct Frame {
    wire::View view;
    int tiles = 0;
    std::size_t bytes = 0;
    bool ended = false;
    bool complete = false;
    std::optional<wire::ShowAt> show_at;
    std::uint64_t cuts = 0;
  };

  explicit FakeDisplay(const std::string& tour, const Panorama& wanted = fake_wall(), bool reports = true)
      : reports_(reports) {
    auto channel = make_channel(tour);
    CHECK(channel);
    stub_ = wire::Tour::NewStub(*channel);
    stream_ = stub_->Show(&context_);
    wire::DisplayReport hello;
    hello.mutable_hello()->set_name("fake");
    hello.mutable_hello()->set_heads(3);
    hello.mutable_hello()->set_refresh_hz(60.0);
    to_wire(wanted, hello.mutable_hello()->mutable_wanted());
    stream_->Write(hello);
    reader_ = std::thread([this] { read(); });
  }
  ~FakeDisplay() { leave(); }
  FakeDisplay(const FakeDisplay&) = delete;
  FakeDisplay& operator=(const FakeDisplay&) = delete;

  void leave() {
    set_reading(true);
    context_.TryCancel();
    if (reader_.joinable()) reader_.join();
  }
  /// Sends a clock request, which also carries the display's synchronisation statistics.
  void ask(const wire::ClockRequest& question) {
    wire::DisplayReport report;
    *report.mutable_clock() = question;
    write(report);
  }
  /// Simulates a slow display by not reading.
  void set_reading(bool reading) {
    {
      const std::lock_guard lock(mutex_);
      reading_ = reading;
    }
    changed_.notify_all();
  }
  bool wait_until(const std::function<bool(const FakeDisplay&)>& condition, Duration limit = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return condition(*this); });
  }
  bool wait_for_frames(std::size_t count) {
    return wait_until([count](const FakeDisplay& d) { return d.frames_complete() >= count; });
  }

  // Valid inside wait_until(), or after leave().
  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<wire::Heading>& headings() const { return headings_; }
  /// Number of headings that carried a presentation time.
  [[nodiscard]] int headings_with_show_at() const { return headings_with_show_at_; }
  [[nodiscard]] const std::vector<wire::Caption>& captions() const { return captions_; }
  [[nodiscard]] const std::vector<wire::ClockReply>& answers() const { return answers_; }
  [[nodiscard]] std::size_t frames_complete() const {
    return static_cast<std::size_t>(
        std::count_if(frames_.begin(), frames_.end(), [](const Frame& f) { return f.complete; }));
  }
  [[nodiscard]] const std::vector<std::string>& wrongs() const { return wrongs_; }
  [[nodiscard]] bool is_over() const { return over_; }
  [[nodiscard]] const grpc::Status& status() const { return status_; }

 private:
  void read() {
    wire::ShowMessage message;
    for (;;) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return reading_; });
      }
      if (!stream_->Read(&message)) break;
      {
        const std::lock_guard lock(mutex_);
        take(message);
      }
      changed_.notify_all();
      if (reports_ && message.has_end() && message.end().complete()) report(message.end().view_number());
    }
    const grpc::Status status = stream_->Finish();
    const std::lock_guard lock(mutex_);
    status_ = status;
    over_ = true;
    changed_.notify_all();
  }
  void report(std::uint64_t number) {
    wire::DisplayReport report;
    report.mutable_presented()->set_view_number(number);
    report.mutable_presented()->set_presented_ns(to_nanoseconds(SteadyClock().now()));
    for (const char* const name : {"decode", "wait", "draw"}) {
      wire::StageTime* const stage = report.mutable_presented()->add_stages();
      stage->set_name(name);
      stage->set_seconds(2e-3);
    }
    write(report);
  }
  void write(const wire::DisplayReport& report) {
    const std::lock_guard lock(writing_);
    stream_->Write(report);
  }
  void take(const wire::ShowMessage& message) {
    const bool open = !frames_.empty() && !frames_.back().ended;
    if (message.has_heading()) {
      if (headings_.empty() != message.heading().has_shown()) wrongs_.push_back("shown is for the first heading");
      headings_.push_back(message.heading());
      headings_with_show_at_ += message.has_show_at() ? 1 : 0;
    } else if (message.has_caption()) {
      if (headings_.empty()) wrongs_.push_back("a caption before the first heading");
      captions_.push_back(message.caption());
    } else if (message.has_clock()) {
      answers_.push_back(message.clock());
    } else if (headings_.empty()) {
      wrongs_.push_back("the first message is not a heading");
    } else if (message.has_begin()) {
      if (open) wrongs_.push_back("a frame begins inside another");
      // A frame that was given up may be requested again under its number, and a complete one may be refined under its
      // number.
      if (!frames_.empty() && message.begin().number() < frames_.back().view.number())
        wrongs_.push_back("an older frame");
      frames_.push_back({message.begin(), 0, 0, false, false, {}, message.cuts()});
    } else if (message.has_tile()) {
      if (!open || frames_.back().view.number() != message.tile().view_number()) {
        wrongs_.push_back("a tile of another frame");
        return;
      }
      ++frames_.back().tiles;
      frames_.back().bytes += payload_bytes(message.tile());
    } else if (message.has_end()) {
      if (!open || frames_.back().view.number() != message.end().view_number()) {
        wrongs_.push_back("an end of another frame");
        return;
      }
      frames_.back().ended = true;
      frames_.back().complete = message.end().complete();
      if (message.has_show_at()) frames_.back().show_at = message.show_at();
      if (message.end().complete() && frames_.back().tiles != static_cast<int>(message.end().tiles())) {
        wrongs_.push_back("a complete frame lacks tiles");
      }
    }
  }

  const bool reports_;
  grpc::ClientContext context_;
  std::unique_ptr<wire::Tour::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::DisplayReport, wire::ShowMessage>> stream_;

  std::mutex writing_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool reading_ = true;
  bool over_ = false;
  grpc::Status status_;
  std::vector<Frame> frames_;
  std::vector<wire::Heading> headings_;
  int headings_with_show_at_ = 0;
  std::vector<wire::ClockReply> answers_;
  std::vector<wire::Caption> captions_;
  std::vector<std::string> wrongs_;

  std::thread reader_;
};

}  // namespace cyclorama
