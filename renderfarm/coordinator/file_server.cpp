// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/file_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "common/base/token_bucket.h"
#include "common/wire/channel.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{512} << 10;
constexpr Duration kLook = std::chrono::seconds(1);
/// Time after which a stream whose peer takes nothing is cut, to free its slot.
constexpr Duration kStall = std::chrono::seconds(60);

const grpc::Status kStops(grpc::StatusCode::UNAVAILABLE, "the farm's coordinator stops");

/// A call that ends at once with an error.
class Refusal final : public grpc::ServerWriteReactor<wire::FileChunk> {
 public:
  explicit Refusal(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

}  // namespace

/// One file being sent. At any time, the stream is in the server's queue, or one of its chunks is being written, or it
/// is finished. gRPC passes it from thread to thread between these states. The mutex is never contended; it only makes
/// the memory ordering visible to sanitizers.
class FileServer::Stream final : public grpc::ServerWriteReactor<wire::FileChunk> {
 public:
  Stream(FileServer& server, grpc::CallbackServerContext* context, scene_distribution::StampedFile file,
         std::uint64_t offset)
      : server_(server), context_(context), who_(identity_of(*context)), file_(std::move(file)), offset_(offset) {
    const std::lock_guard handed_over(hand_over_);
  }

  [[nodiscard]] const Identity& who() const { return who_; }
  [[nodiscard]] bool is_at_end() const { return offset_ == file_.stamp.bytes; }
  [[nodiscard]] bool is_cancelled() const { return context_->IsCancelled(); }
  void end(const grpc::Status& status) { Finish(status); }

  /// Reads and sends the next chunk, and returns its size in bytes. The stream may be deleted when the call returns.
  std::uint64_t send_next() {
    const auto want = std::min<std::uint64_t>(kPieceBytes, file_.stamp.bytes - offset_);
    if (!read_next(want)) {
      end(to_grpc(Error(ErrorCode::kNotFound,
                        "the file was changed on the coordinator's host, or its disk fails; check it there")));
      return 0;
    }
    StartWrite(&chunk_);
    return want;
  }
  void cut_if(const std::function<bool(const Identity&)>& whom) {
    if (whom(who_)) context_->TryCancel();
  }
  void cut_if_stalled(TimePoint now) {
    const Duration::rep since = writing_since_;
    if (since != 0 && now - TimePoint(Duration(since)) > kStall) context_->TryCancel();
  }

 private:
  [[nodiscard]] bool read_next(std::uint64_t want) {
    const std::lock_guard handed_over(hand_over_);
    std::string& data = *chunk_.mutable_data();
    data.resize(want);
    ssize_t got = -1;
    do {
      got = ::pread(file_.fd.get(), data.data(), want, static_cast<off_t>(offset_));
    } while (got < 0 && errno == EINTR);
    if (got != static_cast<ssize_t>(want)) return false;
    chunk_.set_offset(offset_);
    offset_ += want;
    writing_since_ = server_.clock_.now().time_since_epoch().count();
    return true;
  }
  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard handed_over(hand_over_);
      writing_since_ = 0;
      if (ok) server_.sent_bytes_ += chunk_.data().size();
    }
    if (!ok) return end(grpc::Status::CANCELLED);
    if (is_at_end()) return end(grpc::Status::OK);
    server_.queue(*this);
  }
  void OnDone() override {
    { const std::lock_guard handed_over(hand_over_); }
    server_.forget(*this);
    delete this;
  }

  FileServer& server_;
  grpc::CallbackServerContext* const context_;  ///< Owned by gRPC; invalid after OnDone().
  const Identity who_;
  const scene_distribution::StampedFile file_;
  std::uint64_t offset_;
  wire::FileChunk chunk_;
  std::mutex hand_over_;
  std::atomic<Duration::rep> writing_since_ = 0;  ///< Start of the current write as the count of a TimePoint; 0: none.
};

FileServer::FileServer(const scene_distribution::SceneLibrary& library, Options options)
    : library_(library), options_(options), thread_([this] { run(); }) {}

FileServer::~FileServer() {
  stop();
  CHECK(streams_.empty());
}

grpc::ServerUnaryReactor* FileServer::list(grpc::CallbackServerContext* context, const wire::ListFilesRequest& request,
                                           wire::SceneFiles* reply) const {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const bool may_come = library_.is_reading();  // Read first, so that scenes added meanwhile are found.
  const auto files = library_.find(request.digest());
  grpc::Status status;
  if (files != nullptr) {
    *reply = scene_distribution::to_wire(*files);
  } else {
    status = to_grpc(may_come ? Error(ErrorCode::kUnavailable, "it is still reading its scenes")
                              : Error(ErrorCode::kNotFound, "this farm has no such scene (any more)"));
  }
  reactor->Finish(status);
  return reactor;
}

grpc::ServerWriteReactor<wire::FileChunk>* FileServer::fetch(grpc::CallbackServerContext* context,
                                                             const wire::FetchFileRequest& request) {
  return send(context, library_.open(request.sha256()), request.offset());
}

grpc::ServerWriteReactor<wire::FileChunk>* FileServer::send(grpc::CallbackServerContext* context,
                                                            Result<scene_distribution::StampedFile> file,
                                                            std::uint64_t offset) {
  if (!file) return new Refusal(to_grpc(file.error()));
  if (offset > file->stamp.bytes) {
    return new Refusal(to_grpc(Error(ErrorCode::kInvalidArgument, "the offset is beyond the file's end")));
  }
  const std::lock_guard lock(mutex_);
  if (stopping_) return new Refusal(kStops);
  const auto is_museum = [](const Identity& who) { return who.role == Role::kMuseum; };
  const bool is_for_museum = is_museum(identity_of(*context));
  const auto of_museums = std::ranges::count_if(streams_, [&](const Stream* one) { return is_museum(one->who()); });
  if (streams_.size() >= options_.streams ||
      (is_for_museum && static_cast<std::size_t>(of_museums) >= (options_.streams + 1) / 2)) {
    return new Refusal(
        to_grpc(Error(ErrorCode::kBusy, fmt::format("{} files are being sent already; try again", streams_.size()))));
  }
  auto* const stream = new Stream(*this, context, *std::move(file), offset);  // Deletes itself in OnDone().
  streams_.insert(stream);
  if (stream->is_at_end()) {
    stream->end(grpc::Status::OK);
  } else {
    queue_.push_back(stream);
    changed_.notify_one();
  }
  return stream;
}

void FileServer::queue(Stream& stream) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_) {
      queue_.push_back(&stream);
      changed_.notify_one();
      return;
    }
  }
  stream.end(kStops);
}

void FileServer::forget(Stream& stream) {
  const std::lock_guard lock(mutex_);
  streams_.erase(&stream);
}

void FileServer::stop() {
  std::deque<Stream*> left;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    left = std::exchange(queue_, {});
  }
  for (Stream* const stream : left) stream->end(kStops);
}

void FileServer::cut(const std::function<bool(const Identity&)>& whom) {
  const std::lock_guard lock(mutex_);
  for (Stream* const stream : streams_) stream->cut_if(whom);
}

void FileServer::cut_stalled() {
  for (Stream* const stream : streams_) stream->cut_if_stalled(clock_.now());
}

std::vector<FileServer::Stream*> FileServer::take_cancelled() {
  std::vector<Stream*> cancelled;
  std::erase_if(queue_, [&](Stream* stream) {
    if (!stream->is_cancelled()) return false;
    cancelled.push_back(stream);
    return true;
  });
  return cancelled;
}

void FileServer::run() {
  TokenBucket bucket(options_.bytes_per_second, 0.0);
  TimePoint looked = clock_.now();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const TimePoint now = clock_.now();
    if (now - looked > kLook) {
      looked = now;
      cut_stalled();
      const std::vector<Stream*> cancelled = take_cancelled();
      lock.unlock();
      for (Stream* const stream : cancelled) stream->end(grpc::Status::CANCELLED);
      lock.lock();
      continue;
    }
    if (queue_.empty() || bucket.paid_at() > now) {
      changed_.wait_until(lock, queue_.empty() ? now + kLook : std::min(bucket.paid_at(), now + kLook));
      continue;
    }
    Stream& stream = *queue_.front();
    queue_.pop_front();
    lock.unlock();
    const std::uint64_t bytes = stream.send_next();
    lock.lock();
    bucket.take(static_cast<double>(bytes), now);
  }
}

}  // namespace cyclorama::coordinator
