// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/file/file_camera.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "drivers/camera/file/photos.h"
#include "drivers/camera/file/video.h"

namespace cyclorama::camera {
namespace {

/// True if the first bytes are those of a video. All other files go to the photo reader, whose error names common other
/// formats.
bool looks_like_a_video(const std::filesystem::path& path) {
  std::array<char, 12> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  const std::string_view bytes(head.data(), static_cast<std::size_t>(file.gcount()));
  return (bytes.size() == head.size() && bytes.substr(4, 4) == "ftyp") || bytes.starts_with("\x1a\x45\xdf\xa3") ||
         (bytes.starts_with("RIFF") && bytes.ends_with("AVI "));
}

}  // namespace

Result<std::unique_ptr<Camera>> FileCamera::open(const std::filesystem::path& path, const FileCameraOptions& options,
                                                 const Clock& clock) {
  if (options.frames_per_second && !(*options.frames_per_second >= 0.01 && *options.frames_per_second <= 1000.0)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a rate of {} frames per second; it must be 0.01 to 1000", *options.frames_per_second));
  }
  std::error_code ignored;
  const bool video = std::filesystem::is_regular_file(path, ignored) && looks_like_a_video(path);
  TRY_ASSIGN(std::unique_ptr<ImageSequence> recording, video ? Video::open(path) : Photos::open(path));
  const Duration period = period_of(options.frames_per_second.value_or(recording->frames_per_second()));
  const auto name = path.has_filename() ? path.filename() : path.parent_path().filename();
  return std::unique_ptr<Camera>(
      new FileCamera("file:" + name.string(), std::move(recording), period, options.loop, clock));
}

Status FileCamera::start() {
  if (failure_) return *failure_;
  pace_.first_at = clock_.now();
  last_.reset();
  streaming_ = true;
  return Done{};
}

Result<std::shared_ptr<const CameraFrame>> FileCamera::next_frame(TimePoint deadline) {
  if (failure_) return *failure_;
  if (!streaming_) return Error(ErrorCode::kUnavailable, fmt::format("camera '{}' was not started", id_));
  TRY_ASSIGN(const std::uint64_t sequence, wait_for_picture(pace_, last_, clock_, deadline));
  Result<std::optional<GreyImage>> pixels = picture(sequence);
  if (!pixels) {
    failure_ = Error(ErrorCode::kUnavailable, pixels.error().message());
  } else if (!*pixels) {
    failure_ = Error(ErrorCode::kUnavailable, fmt::format("the recording of camera '{}' has ended", id_));
  }
  if (failure_) return *failure_;
  last_ = sequence;
  auto frame = std::make_shared<CameraFrame>();
  frame->pixels = **std::move(pixels);
  frame->sequence = sequence;
  frame->captured_at = pace_.ready_at(sequence);
  return std::shared_ptr<const CameraFrame>(std::move(frame));
}

Result<std::optional<GreyImage>> FileCamera::picture(std::uint64_t sequence) {
  const auto folded = [&] { return loop_ && recording_->count() ? sequence % *recording_->count() : sequence; };
  auto pixels = recording_->picture(folded());
  // The length of a video is known only once its end is reached.
  if (loop_ && pixels && !pixels->has_value()) return recording_->picture(folded());
  return pixels;
}

}  // namespace cyclorama::camera
