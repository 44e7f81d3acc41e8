// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/identity.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/scene_distribution/scene_library.h"

namespace cyclorama::coordinator {

/// Answers Nodes.ListFiles and Nodes.FetchFile: files of the library's scenes, to many nodes at once, piece by piece in
/// turn; and gives museums their updates. Its thread (`files`) reads the disk and keeps the rate, so that neither waits
/// in gRPC's threads nor in the coordinator's loop. Whoever it serves was let in before. Thread-safe.
class FileServer {
 public:
  struct Options {
    double bytes_per_second = 0.0;  ///< To all together; 0: no limit.
    /// Files on their way; more are told to come back. Museums have half of them, so that nodes need not wait.
    std::size_t streams = 64;
  };
  /// The library is borrowed.
  FileServer(const scene_distribution::SceneLibrary& library, Options options);
  /// Every stream must be gone: the gRPC server is stopped first.
  ~FileServer();
  FileServer(const FileServer&) = delete;
  FileServer& operator=(const FileServer&) = delete;

  grpc::ServerUnaryReactor* list(grpc::CallbackServerContext* context, const wire::ListFilesRequest& request,
                                 wire::SceneFiles* reply) const;
  grpc::ServerWriteReactor<wire::FileChunk>* fetch(grpc::CallbackServerContext* context,
                                                   const wire::FetchFileRequest& request);
  /// The same of any file that the caller may give away, from `offset` on; an error is what the peer gets.
  grpc::ServerWriteReactor<wire::FileChunk>* send(grpc::CallbackServerContext* context,
                                                  Result<scene_distribution::StampedFile> file, std::uint64_t offset);
  /// Cuts the streams of those.
  void cut(const std::function<bool(const Identity& who)>& whom);
  /// Ends all streams (UNAVAILABLE), and those that come. Idempotent.
  void stop();

  /// That gRPC took, of all files so far.
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }

 private:
  class Stream;
  void run();
  void queue(Stream& stream);
  void forget(Stream& stream);
  void cut_stalled();
  /// Out of the queue: their turn may be long in coming, and they hold a place.
  std::vector<Stream*> take_cancelled();

  const scene_distribution::SceneLibrary& library_;
  const Options options_;
  const SteadyClock clock_;
  std::atomic<std::uint64_t> sent_bytes_ = 0;

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::set<Stream*> streams_;
  std::deque<Stream*> queue_;  ///< Those that may have their next piece, in turn.
  std::thread thread_;
};

}  // namespace cyclorama::coordinator
