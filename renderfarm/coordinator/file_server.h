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

/// Serves Nodes.ListFiles and Nodes.FetchFile: files of the library's scenes, to many nodes at once, one chunk per node
/// in turn. Also sends updates to museums. The thread `files` reads the disk and limits the rate, so neither blocks
/// gRPC's threads or the coordinator's loop. Callers must be authorized already. Thread-safe.
class FileServer {
 public:
  struct Options {
    double bytes_per_second = 0.0;  ///< Limit for all streams together; 0: no limit.
    /// Maximum number of open streams; further callers must retry. Museums get at most half of the streams, so that
    /// nodes need not wait for museums.
    std::size_t streams = 64;
  };
  /// Keeps a reference to the library.
  FileServer(const scene_distribution::SceneLibrary& library, Options options);
  /// Precondition: all streams have ended, which requires that the gRPC server was stopped first.
  ~FileServer();
  FileServer(const FileServer&) = delete;
  FileServer& operator=(const FileServer&) = delete;

  grpc::ServerUnaryReactor* list(grpc::CallbackServerContext* context, const wire::ListFilesRequest& request,
                                 wire::SceneFiles* reply) const;
  grpc::ServerWriteReactor<wire::FileChunk>* fetch(grpc::CallbackServerContext* context,
                                                   const wire::FetchFileRequest& request);
  /// Sends `file` from `offset` on. The caller must have checked that the peer may have it. An error is sent to the
  /// peer.
  grpc::ServerWriteReactor<wire::FileChunk>* send(grpc::CallbackServerContext* context,
                                                  Result<scene_distribution::StampedFile> file, std::uint64_t offset);
  /// Cancels the streams of the matching peers.
  void cut(const std::function<bool(const Identity& who)>& whom);
  /// Ends all streams, present and future, with UNAVAILABLE. Idempotent.
  void stop();

  /// Returns the number of bytes of all files that gRPC has accepted so far.
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }

 private:
  class Stream;
  void run();
  void queue(Stream& stream);
  void forget(Stream& stream);
  void cut_stalled();
  /// Removes and returns the cancelled streams in the queue, because each occupies a slot and its turn may be far off.
  std::vector<Stream*> take_cancelled();

  const scene_distribution::SceneLibrary& library_;
  const Options options_;
  const SteadyClock clock_;
  std::atomic<std::uint64_t> sent_bytes_ = 0;

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::set<Stream*> streams_;
  std::deque<Stream*> queue_;  ///< Streams that are ready for their next chunk, in the order of their turns.
  std::thread thread_;
};

}  // namespace cyclorama::coordinator
