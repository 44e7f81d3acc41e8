// SPDX-License-Identifier: Apache-2.0
/// A museum's connection to the render farm: sends views, receives frames and reconnects by itself.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/tls.h"
#include "renderfarm/client/view_window.h"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace cyclorama::client {

struct FarmClientOptions {
  /// Addresses of coordinators, such as "[::1]:7401"; tried in this order, cyclically.
  std::vector<std::string> coordinators{};
  std::string scene{};            ///< Empty for the farm's first scene.
  std::string museum{};           ///< Shown to the farm's operator if no certificate states the name.
  std::optional<TlsFiles> tls{};  ///< Empty for an unencrypted connection to a coordinator on this machine.
  /// Timeout for a coordinator that owes an answer; longer than any tile takes to render.
  Duration timeout = std::chrono::seconds(30);
  /// See wire::OpenSession: with a budget, the farm chooses the quality and refines the picture until a new view is
  /// requested.
  double frame_budget_ms = 0.0;
  int reference_samples = 0;
};

/// Receives the farm's replies. All calls come from the client's own thread, one at a time, in this order:
///
///   ( on_lost* on_opened ( on_begin on_tile* on_end )* )*
///
/// With a frame budget, on_begin() states the size of the picture, and an ended frame may come again, refined: same
/// number, more samples. A begun frame always ends; if the coordinator is lost, with `complete` false and the reason.
/// Nothing is read during a call, so a slow listener slows the farm down and never fills memory. May call
/// FarmClient::request(), never stop().
class FarmListener {
 public:
  virtual ~FarmListener() = default;
  /// A session is open. Called again, perhaps with another scene, after each on_lost().
  virtual void on_opened(const wire::SceneDescription& scene) = 0;
  /// No session is open, for this reason. Called again if the reason changes, not at each failed attempt.
  virtual void on_lost(const Error& reason) = 0;
  virtual void on_begin(const wire::View& view) = 0;
  /// The tile is checked: it belongs to the open frame, lies inside it, and was not sent before. The JPEG's bytes are
  /// those from the node.
  virtual void on_tile(wire::Tile tile) = 0;
  /// If `complete`, the tiles cover the whole picture.
  virtual void on_end(const wire::FrameEnd& end) = 0;

 protected:
  FarmListener() = default;
  FarmListener(const FarmListener&) = default;
  FarmListener& operator=(const FarmListener&) = default;
};

/// Keeps one session open during its lifetime. Threads: `farm` (connects, reads, calls the listener) and, while a
/// session is open, `views` (writes, and watches the timeout). Thread-safe.
class FarmClient {
 public:
  /// Borrows the listener until stop() has returned. Does not wait for a connection. Errors: kInvalidArgument if an
  /// address is missing or malformed; with `tls`, also as check(TlsFiles).
  static Result<std::unique_ptr<FarmClient>> start(FarmClientOptions options, FarmListener& listener);
  ~FarmClient();
  FarmClient(const FarmClient&) = delete;
  FarmClient& operator=(const FarmClient&) = delete;

  /// Requests a picture; never blocks. With two frames in flight, or without a session, the view waits in one slot;
  /// returns true if it replaced an older one. Precondition: the view is valid and its number is larger than all
  /// before.
  bool request(wire::View view);

  /// Ends the session and joins the threads; the listener is not called afterwards. Idempotent.
  void stop();

 private:
  class Session;
  FarmClient(FarmClientOptions options, std::vector<std::shared_ptr<grpc::Channel>> channels, FarmListener& listener);
  void run();
  Error session(const std::shared_ptr<grpc::Channel>& channel, bool* ret_opened);
  void write_views(Session& session);
  Status handle(const wire::SessionReply& reply, bool* ret_opened);
  void lose(const Error& reason);
  bool wait_before_retry(Duration delay, grpc::Channel& next);

  const FarmClientOptions options_;
  const std::vector<std::shared_ptr<grpc::Channel>> channels_;
  FarmListener& listener_;
  std::string last_reason_;  ///< Used by the farm thread only.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  TimePoint heard_at_{};  ///< Last reply, or last request while no answer was due.
  ViewWindow window_;
  grpc::ClientContext* context_ = nullptr;  ///< Context of the current call, so that stop() can cancel it.

  std::thread farm_;  ///< Last member: started when all others exist.
};

}  // namespace cyclorama::client
