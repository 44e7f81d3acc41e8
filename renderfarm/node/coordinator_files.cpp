// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/coordinator_files.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "common/base/clock.h"
#include "common/wire/channel.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {
namespace {

constexpr Duration kLook = std::chrono::milliseconds(50);
/// Timeout for the next chunk. It is long because a coordinator that serves many nodes at a limited rate may be slow.
constexpr Duration kSilence = std::chrono::seconds(60);
constexpr auto kListDeadline = std::chrono::seconds(10);
constexpr std::size_t kPieceBytes = std::size_t{512} << 10;

}  // namespace

/// Cancels the current call once it is unwanted or silent. Uses its own thread, because the call itself blocks.
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

namespace {

/// Makes a CallWatch watch a call for as long as this object exists.
class Watched {
 public:
  Watched(CallWatch& watch, grpc::ClientContext& context) : watch_(watch) { watch_.watch(&context); }
  ~Watched() { watch_.watch(nullptr); }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

 private:
  CallWatch& watch_;
};

}  // namespace

CoordinatorFiles::CoordinatorFiles(const std::shared_ptr<grpc::Channel>& channel,
                                   const std::function<bool()>& cancelled)
    : stub_(wire::Nodes::NewStub(channel)), watch_(std::make_unique<CallWatch>(cancelled)) {}

CoordinatorFiles::~CoordinatorFiles() = default;

Result<scene_distribution::SceneFiles> CoordinatorFiles::list(const std::string& digest) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kListDeadline);
  const Watched watched(*watch_, context);
  wire::ListFilesRequest request;
  request.set_digest(digest);
  wire::SceneFiles reply;
  if (const grpc::Status status = stub_->ListFiles(&context, request, &reply); !status.ok()) {
    return from_grpc(status, "requesting the scene's files from the coordinator");
  }
  return scene_distribution::from_wire(reply, digest);
}

Status CoordinatorFiles::read(const std::string& sha256, std::uint64_t offset, const Sink& sink) {
  grpc::ClientContext context;
  const Watched watched(*watch_, context);
  wire::FetchFileRequest request;
  request.set_sha256(sha256);
  request.set_offset(offset);
  const auto stream = stub_->FetchFile(&context, request);
  Status fine = Done{};
  wire::FileChunk chunk;
  while (fine && stream->Read(&chunk)) {
    watch_->heard();
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

Result<std::vector<std::byte>> CoordinatorFiles::whole(const std::string& sha256, std::uint64_t max_bytes) {
  std::vector<std::byte> bytes;
  scene_distribution::Sha256 sum;
  TRY(read(sha256, 0, [&](std::span<const std::byte> piece) -> Status {
    if (bytes.size() + piece.size() > max_bytes) {
      return Error(ErrorCode::kBadData, fmt::format("the coordinator sent more than {} bytes", max_bytes));
    }
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    sum.add(piece);
    return Done{};
  }));
  if (sum.hexadecimal() != sha256) return Error(ErrorCode::kBadData, "the coordinator sent other bytes than announced");
  return bytes;
}

Status CoordinatorFiles::store_light(const std::string& version, std::span<const std::byte> file) {
  grpc::ClientContext context;
  const Watched watched(*watch_, context);
  wire::StoreLightReply reply;
  const auto stream = stub_->StoreLight(&context, &reply);
  wire::LightChunk chunk;
  chunk.set_version(version);
  for (bool fine = true; fine && !file.empty();) {
    const std::size_t size = std::min(kPieceBytes, file.size());
    chunk.set_data(file.data(), size);
    fine = stream->Write(chunk);
    chunk.clear_version();
    file = file.subspan(size);
    watch_->heard();
  }
  stream->WritesDone();
  if (const grpc::Status status = stream->Finish(); !status.ok()) return from_grpc(status, "the coordinator");
  return Done{};
}

}  // namespace cyclorama::node
