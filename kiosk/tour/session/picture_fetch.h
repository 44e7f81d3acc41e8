// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "kiosk/tour/session/kept_picture.h"
#include "renderfarm/client/farm_client.h"

namespace cyclorama::tour {

/// One picture, rendered until it has converged, in a session of its own beside the visit's. Thread-safe.
class PictureFetch final : private client::FarmListener {
 public:
  /// Begins. Errors: those of FarmClient::start().
  static Result<std::unique_ptr<PictureFetch>> start(client::FarmClientOptions options, wire::View view);
  ~PictureFetch() override;
  PictureFetch(const PictureFetch&) = delete;
  PictureFetch& operator=(const PictureFetch&) = delete;

  /// Returns the picture, or the reason why there is none, once either is known. Moves it out.
  [[nodiscard]] std::optional<Result<KeptPicture>> take_result();

 private:
  explicit PictureFetch(wire::View view) : wanted_(std::move(view)) {}
  void on_opened(const wire::SceneDescription& scene) override;
  void on_lost(const Error& reason) override;
  void on_begin(const wire::View& view) override;
  void on_tile(wire::Tile tile) override;
  void on_end(const wire::FrameEnd& end) override;

  const wire::View wanted_;
  KeptPicture picture_;  ///< Farm thread only.

  std::mutex mutex_;  ///< Guards the following.
  std::optional<Result<KeptPicture>> result_;

  std::unique_ptr<client::FarmClient> farm_;  ///< Last member, because its thread uses all others.
};

}  // namespace cyclorama::tour
