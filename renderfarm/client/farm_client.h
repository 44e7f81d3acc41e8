// SPDX-License-Identifier: Apache-2.0
/// A museum's link to the render farm: views go out, frames come in, and it heals by itself.
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

namespace cyclorama {

struct FarmClientOptions {
  std::vector<std::string> heads{};  ///< "[::1]:7401"; tried in this order, the first again after the last.
  std::string scene{};               ///< Empty: the farm's first.
  std::string museum{};              ///< Shown to the farm's operator, where no certificate says it.
  std::optional<TlsFiles> tls{};     ///< Nothing: not encrypted, for a head on this machine.
  /// A head that owes an answer and says nothing for this long is given up. Longer than any tile takes to render.
  Duration patience = std::chrono::seconds(30);
  /// As wire::OpenVisit: with a budget, the farm chooses the quality, and refines while no new view is requested.
  double frame_budget_ms = 0.0;
  int reference_samples = 0;
};

/// What the farm says. Every call comes on the client's own thread, one at a time, in this order:
///
///   ( on_lost* on_opened ( on_begin on_tile* on_end )* )*
///
/// With a frame budget, on_begin() says how large the picture is, and a frame that was ended may come again, refined:
/// same number, more samples. A begun frame always ends: when the head goes away, with `complete` false and the reason.
/// While a call runs nothing more is read, so a slow listener slows the farm and never fills memory. May call
/// FarmClient::request(), never stop().
class FarmListener {
 public:
  virtual ~FarmListener() = default;
  /// A visit is open. Comes again, perhaps with another scene, after each on_lost().
  virtual void on_opened(const wire::SceneDescription& scene) = 0;
  /// No visit is open, and why. Comes again when the reason changes, not at each vain attempt.
  virtual void on_lost(const Error& reason) = 0;
  virtual void on_begin(const wire::View& view) = 0;
  /// Checked: belongs to the open frame, lies inside it, was not sent before. The JPEG's bytes are as the node made
  /// them.
  virtual void on_tile(wire::Tile tile) = 0;
  /// When `complete`, the tiles cover the whole picture.
  virtual void on_end(const wire::FrameEnd& end) = 0;

 protected:
  FarmListener() = default;
  FarmListener(const FarmListener&) = default;
  FarmListener& operator=(const FarmListener&) = default;
};

/// Keeps one visit open as long as it lives. Threads: `farm` (dials, reads, calls the listener) and, while a visit is
/// open, `views` (writes, and watches the patience). Thread-safe.
class FarmClient {
 public:
  /// The listener is borrowed until stop() has returned. Does not wait for a connection.
  /// kInvalidArgument  no head, or an address that is none.     With `tls` also as check(TlsFiles).
  static Result<std::unique_ptr<FarmClient>> start(FarmClientOptions options, FarmListener& listener);
  ~FarmClient();
  FarmClient(const FarmClient&) = delete;
  FarmClient& operator=(const FarmClient&) = delete;

  /// Asks for a picture; never blocks. With two frames in flight, or without a visit, the view waits in one slot;
  /// returns true if it took the place of an older one. Precondition: the view is valid and its number larger than all
  /// before.
  bool request(wire::View view);

  /// Ends the visit and joins the threads; the listener is not called any more. Idempotent.
  void stop();

 private:
  class Visit;
  FarmClient(FarmClientOptions options, std::vector<std::shared_ptr<grpc::Channel>> channels, FarmListener& listener);
  void run();
  Error visit(const std::shared_ptr<grpc::Channel>& channel, bool* ret_opened);
  void write_views(Visit& visit);
  Status handle(const wire::VisitReply& reply, bool* ret_opened);
  void lose(const Error& reason);
  bool wait_before_retry(Duration delay, grpc::Channel& next);

  const FarmClientOptions options_;
  const std::vector<std::shared_ptr<grpc::Channel>> channels_;
  FarmListener& listener_;
  std::string last_reason_;  ///< Farm thread only.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  TimePoint heard_at_{};  ///< When the farm last said something, or was last asked while it owed nothing.
  ViewWindow window_;
  grpc::ClientContext* context_ = nullptr;  ///< Of the current call, so that stop() can cancel it.

  std::thread farm_;  ///< Last: started when everything else is made.
};

}  // namespace cyclorama
