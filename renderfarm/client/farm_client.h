// SPDX-License-Identifier: Apache-2.0
/// A museum's connection to the render farm: sends views, receives frames, and reconnects by itself.
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
  /// Addresses of coordinators, such as "[::1]:7401". They are tried in this order, cyclically.
  std::vector<std::string> coordinators{};
  std::string scene{};            ///< Empty selects the farm's first scene.
  std::string museum{};           ///< Name shown to the farm's operator if no certificate states one.
  std::optional<TlsFiles> tls{};  ///< Empty: an unencrypted connection to a coordinator on this machine.
  /// Timeout for replies of a coordinator; longer than any tile takes to render.
  Duration timeout = std::chrono::seconds(30);
  /// See wire::OpenSession. With a budget, the farm chooses the quality, and refines the picture until a new view is
  /// requested.
  double frame_budget_ms = 0.0;
  int reference_samples = 0;
};

/// Receives the farm's replies. All calls come from the client's thread, one at a time, in this order:
///
///   ( on_lost* on_opened ( on_begin on_tile* on_end )* )*
///
/// With a frame budget, on_begin() states the size of the picture, and an ended frame may begin again as a refinement
/// with the same number and more samples. A frame that began always ends; if the coordinator is lost, it ends with
/// `complete` false and the reason. Nothing is read during a call, so a slow listener slows the farm down instead of
/// filling memory. A call may use FarmClient::request(), but not stop().
class FarmListener {
 public:
  virtual ~FarmListener() = default;
  /// Called when a session is open; again after each on_lost(), perhaps with another scene.
  virtual void on_opened(const wire::SceneDescription& scene) = 0;
  /// Called with the reason why no session is open; again if the reason changes, but not for each failed attempt.
  virtual void on_lost(const Error& reason) = 0;
  virtual void on_begin(const wire::View& view) = 0;
  /// Called for a valid tile: it belongs to the open frame, is inside it, and was not sent before. The JPEG is
  /// unchanged from the node.
  virtual void on_tile(wire::Tile tile) = 0;
  /// Called at a frame's end. If `complete`, the tiles cover the whole picture.
  virtual void on_end(const wire::FrameEnd& end) = 0;

 protected:
  FarmListener() = default;
  FarmListener(const FarmListener&) = default;
  FarmListener& operator=(const FarmListener&) = default;
};

/// Keeps one session open as long as this object exists. Threads: `farm` (connects, reads, calls the listener) and,
/// while a session is open, `views` (writes, and checks the timeout). Thread-safe.
class FarmClient {
 public:
  /// Starts the client; does not wait for a connection. Borrows the listener until stop() has returned. Errors:
  /// kInvalidArgument if an address is missing or malformed; with `tls`, also those of check(TlsFiles).
  static Result<std::unique_ptr<FarmClient>> start(FarmClientOptions options, FarmListener& listener);
  ~FarmClient();
  FarmClient(const FarmClient&) = delete;
  FarmClient& operator=(const FarmClient&) = delete;

  /// Requests a picture; never blocks. With two frames in flight, or without a session, the view waits in one slot.
  /// Returns true if it replaced an older view there. Precondition: the view is valid, and its number is larger than
  /// all earlier ones.
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
  std::string last_reason_;  ///< Farm thread only.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  TimePoint heard_at_{};  ///< Start of the timeout: the last reply, or a later request sent when none was in flight.
  ViewWindow window_;
  grpc::ClientContext* context_ = nullptr;  ///< Context of the current call, so that stop() can cancel it.

  std::thread farm_;  ///< Last member, because the thread uses all others.
};

}  // namespace cyclorama::client
