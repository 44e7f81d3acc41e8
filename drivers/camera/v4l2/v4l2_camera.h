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
  /// Exposure time, short so that a moving hand stays sharp: at 1 m/s and a distance of 1 m, a 60° lens with a picture
  /// of 640 px smears 0.55 px per ms. Zero selects the device's automatic exposure.
  Duration exposure = std::chrono::milliseconds(5);
  BufferMemory memory = BufferMemory::kMapped;
  GainRule gain = GainRule::kFollowsLight;
};

/// A V4L2 camera or frame grabber. The newest picture wins: older filled buffers are returned to the driver unread.
/// Thread-bound except for id().
///
/// The camera is Failed after it was unplugged, after a change of the signal's format, and after a stream error; it
/// must then be opened again. Damaged pictures are skipped and appear as a gap in the next frame's sequence; a device
/// that sends nothing leads to timeouts, which the caller handles.
class V4l2Camera final : public Camera {
 public:
  /// Reads the formats that the device offers, without reserving anything. `where` is as in open_video_device().
  /// Borrows `clock`, which must have the time base of CLOCK_MONOTONIC.
  ///
  /// Errors: kNotFound, kBusy, kUnavailable and kSystem as open_video_device().
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
  /// Applies all device settings and starts streaming.
  Status set_up();
  /// Waits until the driver has a picture or an event; false if neither comes before the deadline. Errors: kUnavailable
  /// once Failed.
  Result<bool> wait(TimePoint deadline);
  struct Newest {
    std::optional<FilledBuffer> filled;  ///< Nothing if all pictures were damaged.
    bool is_stale = false;               ///< The driver had filled all buffers and dropped later pictures.
  };
  /// Takes the newest undamaged picture among the filled buffers and returns the others to the driver.
  Result<Newest> take_newest();
  /// Like take_newest(), but waits for the next picture, at most until the deadline, rather than return a stale one.
  Result<std::optional<FilledBuffer>> take_new(TimePoint deadline);
  /// Decodes a buffer; returns null if the picture is damaged.
  Result<std::shared_ptr<const CameraFrame>> read(const FilledBuffer& filled);
  void follow_light(const GreyImage& picture);
  /// Stores the error, releases the buffers, and returns the error.
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
  std::string damage_;  ///< Damage of the last dropped picture; empty after a good one.
  std::uint64_t sequence_ = 0;
  std::optional<std::uint32_t> last_kernel_sequence_;
  int pictures_since_gain_ = 0;
};

}  // namespace cyclorama::camera
