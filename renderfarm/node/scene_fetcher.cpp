// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_fetcher.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "common/base/clock.h"
#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {
namespace {

constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kMaxRetryDelay = std::chrono::seconds(2);
constexpr Duration kLook = std::chrono::milliseconds(50);
/// Timeout for the next chunk, since a coordinator that serves many nodes at a limited rate may be slow.
constexpr Duration kSilence = std::chrono::seconds(60);
constexpr auto kListDeadline = std::chrono::seconds(10);

/// Cancels the current call once it is unwanted or silent, from a thread of its own, because the call itself blocks.
/// Thread-safe.
class CallWatch {
 public:
  explicit CallWatch(const std::function<bool()>& cancelled)
      : cancelled_(cancelled), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void watch(grpc::ClientContext* context) {
    const std::lock_guard lock(mutex_);
    context_ = context;
    heard_at_ = SteadyClock().now();
  }
  void heard() {
    const std::lock_guard lock(mutex_);
    heard_at_ = SteadyClock().now();
  }

 private:
  void run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      if (context_ != nullptr && (cancelled_() || SteadyClock().now() - heard_at_ > kSilence)) context_->TryCancel();
      changed_.wait_for(lock, stop, kLook, [] { return false; });
    }
  }

  const std::function<bool()>& cancelled_;
  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable_any changed_;
  grpc::ClientContext* context_ = nullptr;
  TimePoint heard_at_{};
  std::jthread thread_;
};

/// Watches the call during its own lifetime.
class Watched {
 public:
  Watched(CallWatch& watch, grpc::ClientContext& context) : watch_(watch) { watch_.watch(&context); }
  ~Watched() { watch_.watch(nullptr); }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

 private:
  CallWatch& watch_;
};

/// The coordinator as a source of files.
class CoordinatorFileSource final : public scene_distribution::FileSource {
 public:
  CoordinatorFileSource(const std::shared_ptr<grpc::Channel>& channel, CallWatch& watch)
      : stub_(wire::Nodes::NewStub(channel)), watch_(watch) {}

  Result<scene_distribution::SceneFiles> list(const std::string& digest) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kListDeadline);
    const Watched watched(watch_, context);
    wire::ListFilesRequest request;
    request.set_digest(digest);
    wire::SceneFiles reply;
    if (const grpc::Status status = stub_->ListFiles(&context, request, &reply); !status.ok()) {
      return from_grpc(status, "requesting the scene's files from the coordinator");
    }
    return scene_distribution::from_wire(reply, digest);
  }

  Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) override {
    grpc::ClientContext context;
    const Watched watched(watch_, context);
    wire::FetchFileRequest request;
    request.set_sha256(sha256);
    request.set_offset(offset);
    const auto stream = stub_->FetchFile(&context, request);
    Status fine = Done{};
    wire::FileChunk chunk;
    while (fine && stream->Read(&chunk)) {
      watch_.heard();
      fine = chunk.offset() == offset ? sink(std::as_bytes(std::span(chunk.data())))
                                      : Error(ErrorCode::kBadData, "the coordinator sent its pieces out of order");
      offset += chunk.data().size();
    }
    if (!fine) context.TryCancel();
    const grpc::Status status = finish_after_read(context, [&] { return stream->Finish(); });
    if (!fine) return fine;
    if (!status.ok()) return from_grpc(status, "the coordinator");
    return Done{};
  }

 private:
  const std::unique_ptr<wire::Nodes::Stub> stub_;
  CallWatch& watch_;
};

bool may_pass(const Error& error) {
  return error.code() == ErrorCode::kUnavailable || error.code() == ErrorCode::kTimedOut ||
         error.code() == ErrorCode::kBusy;
}

/// Returns false if cancelled meanwhile.
bool wait(Duration delay, const std::function<bool()>& cancelled) {
  const SteadyClock clock;
  const TimePoint end = clock.now() + delay;
  while (clock.now() < end && !cancelled()) clock.wait_until(std::min(end, clock.now() + kLook));
  return !cancelled();
}

}  // namespace

std::optional<scene_distribution::SceneCache::Held> SceneFetcher::found_before(const wire::LoadScene& order) const {
  const auto known = found_.find(order.digest());
  if (!order.path().empty() || known == found_.end()) return std::nullopt;
  scene_distribution::SceneCache::Held found;
  found.path = known->second;
  return found;
}

Result<scene_distribution::SceneCache::Held> SceneFetcher::find(const wire::LoadScene& order,
                                                                const std::shared_ptr<grpc::Channel>& coordinator,
                                                                const std::function<void(std::string)>& report_progress,
                                                                const std::function<bool()>& cancelled) {
  if (!order.path().empty()) {
    scene_distribution::SceneCache::Held on_disk;
    on_disk.path = order.path();
    return on_disk;
  }
  if (coordinator == nullptr || !scene_distribution::is_sha256(order.digest()))
    return Error(ErrorCode::kBadData, "the coordinator gave neither a path nor a digest");
  if (options_.folder.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 "the coordinator distributes this scene, and this node has no cache for it; write "
                 "'cache' in node.toml, or --cache FOLDER");
  }
  if (!cache_) {
    TRY_ASSIGN(cache_, scene_distribution::SceneCache::open(options_));
  }
  CallWatch watch(cancelled);
  CoordinatorFileSource source(coordinator, watch);
  const std::string scene = printable(order.scene());
  const auto progress = [&](const char* doing, double fraction) {
    report_progress(fmt::format("{} scene '{}': {:.0f} %", doing, scene, 100.0 * fraction));
    return !cancelled();
  };
  for (Duration delay = kFirstRetry;; delay = std::min(2 * delay, kMaxRetryDelay)) {
    const auto files = source.list(order.digest());
    auto held = files ? cache_->bring(*files, source, progress) : Error(files.error());
    if (held) found_[order.digest()] = held->path;
    if (held || !may_pass(held.error())) return held;
    report_progress(fmt::format("fetching scene '{}': {}; trying again", scene, held.error().message()));
    if (!wait(delay, cancelled))
      return Error(ErrorCode::kUnavailable, "given up: the coordinator is gone, or no longer needs the scene");
  }
}

}  // namespace cyclorama::node
