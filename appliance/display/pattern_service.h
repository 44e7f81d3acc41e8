// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "appliance/display/pattern_wall.h"
#include "common/base/result.h"
#include "common/wire/calibration.grpc.pb.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Implements calibration.proto's PatternScreen: passes the patterns of its one stream to the presenter. Decodes
/// pictures on gRPC's threads. Thread-safe, except tend().
class PatternService final : public wire::PatternScreen::Service {
 public:
  /// `heads` are those of the output, in order. Borrows the mailbox. A call without a request for `idle` is ended: a
  /// user who turns the turntable by hand may take time, but a calibration that hangs must not keep the wall from
  /// visitors. A call fails if a head has not shown its pattern within `timeout`.
  PatternService(std::vector<output::HeadMode> heads, PatternMailbox* mailbox, Duration idle,
                 Duration timeout = std::chrono::seconds(10))
      : heads_(std::move(heads)), mailbox_(*mailbox), idle_(idle), timeout_(timeout) {}

  /// Takes the presenter's reports, frees objects that the presenter no longer uses, and ends a call that is idle.
  /// Called by one thread, at each refresh.
  void tend();
  /// Wakes every call that waits for the presenter. To be called before the presenter ends.
  void stop();
  /// True while patterns are shown instead of the show.
  [[nodiscard]] bool is_open() const { return is_open_; }
  /// Shows a picture on each head instead of the show, as long as no patterns are shown; none: the show. They have the
  /// heads' sizes.
  void set_notice(const std::vector<std::shared_ptr<const RgbaImage>>& pictures);
  [[nodiscard]] bool has_notice() const { return has_notice_; }

 private:
  using Stream = grpc::ServerReaderWriter<wire::PatternShown, wire::PatternRequest>;
  grpc::Status ShowPatterns(grpc::ServerContext* context, Stream* stream) override;
  grpc::Status serve(grpc::ServerContext* context, Stream* stream);
  Status take(const wire::PatternRequest& order, std::vector<PatternWall::Head>* heads) const;
  std::uint64_t put(bool is_open, std::vector<PatternWall::Head> heads);
  std::uint64_t put_notice();
  std::uint64_t put_locked(bool is_open, std::vector<PatternWall::Head> heads);  // Precondition: putting_ is held.
  bool read(grpc::ServerContext* context, Stream* stream, wire::PatternRequest* ret);
  Result<TimePoint> wait_for(std::uint64_t order, const grpc::ServerContext& context);

  const std::vector<output::HeadMode> heads_;
  PatternMailbox& mailbox_;
  const Duration idle_;
  const Duration timeout_;
  std::atomic<bool> is_open_{false};
  std::atomic<bool> has_notice_{false};
  std::mutex putting_;                     // Guards the next three members. Never locked by the present thread.
  std::uint64_t order_ = 0;                // PatternWall::order of the newest wall.
  bool is_stream_putting_ = false;         // The walls are the stream's.
  std::vector<PatternWall::Head> notice_;  // Pictures while there is no stream; empty: the show.
  std::mutex mutex_;                       // Guards the members below. Never locked by the present thread.
  PatternsShown shown_;
  bool stops_ = false;
  grpc::ServerContext* waiting_ = nullptr;  // The call that waits for a request; null if none does.
  TimePoint waits_since_{};                 // Time since which that call waits.
  std::condition_variable changed_;
};

}  // namespace cyclorama::display
