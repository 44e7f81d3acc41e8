// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/camera/camera.h"
#include "drivers/camera/picture_choice.h"
#include "drivers/camera/v4l2/exposure.h"
#include "drivers/camera/v4l2/stream_buffers.h"
#include "drivers/camera/v4l2/video_nodes.h"

namespace cyclorama::camera {

struct V4l2CameraOptions {
  PicturePreference preferred;
  /// Short, so that a moving hand stays sharp: at 1 m/s and 1 m away, a 60° lens of 640 px smears 0.55 px per ms. Zero:
  /// the device's automatic.
  Duration exposure = std::chrono::milliseconds(5);
  BufferMemory memory = BufferMemory::kMapped;
  GainRule gain = GainRule::kFollowsLight;
};

/// A camera, or a frame grabber, of the kernel's. The newest picture wins: what the driver filled meanwhile goes back
/// to it unread. Thread-bound, but for id().
///
/// What ends it (Failed; the next start is a new Camera's): unplugged, another shape of the signal, a broken stream.
/// What does not: damaged pictures, which are counted in the next frame's gap, and silence, which is the caller's to
/// end.
class V4l2Camera final : public Camera {
 public:
  /// `where` as in open_video_device(). Looks what the device offers; takes nothing of it yet. Borrows `clock`, which
  /// must run as CLOCK_MONOTONIC does.
  ///
  /// kNotFound, kBusy, kUnavailable, kSystem  as open_video_device().
  static Result<std::unique_ptr<Camera>> open(std::string_view where, const V4l2CameraOptions& options,
                                              const Clock& clock);
  ~V4l2Camera() override { stop(); }

  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override;
  Result<std::shared_ptr<const CameraFrame>> next_frame(TimePoint deadline) override;
  void stop() override { buffers_.reset(); }

 private:
  V4l2Camera(NamedDevice named, PictureOffer offer, const V4l2CameraOptions& options, const Clock& clock)
      : id_("v4l2:" + named.port_path),
        device_(std::move(named.device)),
        offer_(offer),
        options_(options),
        clock_(clock) {}
  /// Sets all of the device, and streams.
  Status set_up();
  /// Waits until the driver has something. False: nothing before the deadline. Failed: kUnavailable.
  Result<bool> wait(TimePoint deadline);
  struct Newest {
    std::optional<FilledBuffer> filled;  ///< Nothing: none was whole.
    bool is_stale = false;               ///< The driver had filled all that it has, and dropped what came after.
  };
  /// Of all that is filled now, the newest that is whole; the others go back.
  Result<Newest> take_newest();
  /// As take_newest(), but instead of a stale picture the next one, if it comes before the deadline.
  Result<std::optional<FilledBuffer>> take_new(TimePoint deadline);
  /// Nothing: the picture is damaged.
  Result<std::shared_ptr<const CameraFrame>> read(const FilledBuffer& filled);
  void follow_light(const GreyImage& picture);
  /// Remembers why, frees the device, and says it.
  Error fail(Error error);

  std::string id_;
  VideoDevice device_;
  PictureOffer offer_;
  V4l2CameraOptions options_;
  const Clock& clock_;
  PictureFormat format_;
  ExposureSet exposure_;
  std::optional<StreamBuffers> buffers_;
  std::optional<Error> failure_;
  JpegDecoder jpeg_;
  std::string damage_;  ///< What was wrong with the last picture that was dropped; empty after a good one.
  std::uint64_t sequence_ = 0;
  std::optional<std::uint32_t> last_kernel_sequence_;
  int pictures_since_gain_ = 0;
};

}  // namespace cyclorama::camera
