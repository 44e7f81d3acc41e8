// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/camera/camera.h"
#include "drivers/camera/file/image_sequence.h"
#include "drivers/camera/pace.h"

namespace cyclorama::camera {

struct FileCameraOptions {
  std::optional<double> frames_per_second;  ///< 0.01 to 1000; the recording's own rate if not given.
  bool loop = true;                         ///< If false, the camera fails after the last picture, as if unplugged.
};

/// Replays a photo, a folder of photos or a video in real time, as if a camera saw it now. The kind of file follows
/// from its first bytes, not from its name. Thread-bound except for id().
class FileCamera final : public Camera {
 public:
  /// Reads the first picture. `clock` must outlive the camera.
  ///
  /// Errors: kNotFound if there is no such file or folder, or a folder has no photos; kBadData if the file is damaged
  /// or neither a photo nor a video (the message says what it is and what to do); kInvalidArgument if the rate is out
  /// of range.
  static Result<std::unique_ptr<Camera>> open(const std::filesystem::path& path, const FileCameraOptions& options,
                                              const Clock& clock);

  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override;
  Result<std::shared_ptr<const CameraFrame>> next_frame(TimePoint deadline) override;
  void stop() override { streaming_ = false; }

 private:
  FileCamera(std::string id, std::unique_ptr<ImageSequence> recording, Duration period, bool loop, const Clock& clock)
      : id_(std::move(id)), recording_(std::move(recording)), loop_(loop), clock_(clock) {
    pace_.period = period;
  }
  Result<std::optional<GreyImage>> picture(std::uint64_t sequence);

  std::string id_;
  std::unique_ptr<ImageSequence> recording_;
  bool loop_;
  const Clock& clock_;
  Pace pace_;
  std::optional<std::uint64_t> last_;
  bool streaming_ = false;
  std::optional<Error> failure_;
};

}  // namespace cyclorama::camera
