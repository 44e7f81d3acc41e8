// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/show_stream.h"

#include <utility>

namespace cyclorama::display {
namespace {
constexpr std::size_t kMaxReports = 256;
/// Time for gRPC to report the end of a call that the tour has ended; it usually takes much less.
constexpr Duration kEndsWithin = std::chrono::seconds(1);
}  // namespace

ShowStream::ShowStream(const std::shared_ptr<grpc::Channel>& channel, const wire::DisplayHello& hello,
                       Listener listener)
    : stub_(wire::Tour::NewStub(channel)), listener_(std::move(listener)) {
  wire::DisplayReport first;
  *first.mutable_hello() = hello;
  stub_->async()->Show(&context_, this);
  // The hold lasts until OnReadDone reports the end of the stream, since writes also start on threads other than
  // gRPC's.
  AddHold();
  StartRead(&message_);
  StartCall();
  report(std::move(first));
}

ShowStream::~ShowStream() {
  context_.TryCancel();
  std::unique_lock lock(mutex_);
  // gRPC guarantees OnDone after a cancel; without it there is no safe way to continue.
  CHECK(changed_.wait_for(lock, std::chrono::seconds(30), [this] { return end_.has_value(); }));
}

void ShowStream::report(wire::DisplayReport report) {
  const std::lock_guard lock(mutex_);
  if (is_ending_ || reports_.size() >= kMaxReports) return;
  reports_.push_back(std::move(report));
  if (!is_writing_) write_next();
}

void ShowStream::write_next() {
  is_writing_ = !reports_.empty() && !is_ending_;
  if (is_writing_) StartWrite(&reports_.front());
}

bool ShowStream::is_up() const {
  const std::lock_guard lock(mutex_);
  return is_up_ && !end_;
}

std::optional<Error> ShowStream::end() {
  const std::lock_guard lock(mutex_);
  if (read_failed_at_ && !end_ && !is_given_up_ && SteadyClock().now() - *read_failed_at_ > kEndsWithin) {
    is_given_up_ = true;
    context_.TryCancel();
  }
  return end_;
}

void ShowStream::OnReadInitialMetadataDone(bool ok) {
  const std::lock_guard lock(mutex_);
  is_up_ = is_up_ || ok;
}

void ShowStream::OnReadDone(bool ok) {
  {
    const std::lock_guard serial(listening_);
    {
      const std::lock_guard lock(mutex_);
      is_up_ = is_up_ || ok;
      is_ending_ = !ok;
      if (!ok) read_failed_at_ = SteadyClock().now();
    }
    if (ok) listener_(std::move(message_));
  }
  if (!ok) return RemoveHold();
  message_.Clear();
  StartRead(&message_);
}

void ShowStream::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  reports_.pop_front();
  is_writing_ = false;
  if (ok) write_next();
}

void ShowStream::OnDone(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  end_ = status.ok() ? Error(ErrorCode::kUnavailable, "showing the tour: the tour closed the stream")
                     : from_grpc(is_given_up_ ? unreadable() : status, "showing the tour");
  changed_.notify_all();  // Under the lock, since the destructor frees this object as soon as it has the lock.
}

}  // namespace cyclorama::display
