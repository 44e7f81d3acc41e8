// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/v4l2_camera.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>

namespace cyclorama::camera {
namespace {

/// A new gain takes effect after about three pictures; brightness is evaluated again only after that.
constexpr int kPicturesPerGain = 8;
/// Bounds the loop for a device that fills buffers as quickly as they are returned.
constexpr std::size_t kMaxBuffersTaken = 16;

timespec timeout_until(TimePoint deadline, TimePoint now) {
  const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(std::max(deadline - now, Duration::zero()));
  timespec timeout{};
  timeout.tv_sec = left.count() / 1'000'000'000;
  timeout.tv_nsec = left.count() % 1'000'000'000;
  return timeout;
}

}  // namespace

Result<std::unique_ptr<Camera>> V4l2Camera::open(std::string_view where, const V4l2CameraOptions& options,
                                                 const Clock& clock) {
  TRY_ASSIGN(NamedDevice named, open_video_device(where));
  // A frame grabber offers the size of its signal. Without a signal, start() reports the error.
  static_cast<void>(named.device.follow_signal());
  TRY_ASSIGN(const std::vector<PictureOffer> offers, named.device.offers(options.preferred));
  auto chosen = choose_picture(offers, options.preferred);
  if (!chosen) return std::move(chosen).error().while_doing(fmt::format("camera at {}", named.port_path));
  return std::unique_ptr<Camera>(new V4l2Camera(std::move(named), offers[*chosen], options, clock));
}

Error V4l2Camera::fail(Error error) {
  buffers_.reset();
  failure_ = Error(ErrorCode::kUnavailable, error.message());
  return *failure_;
}

Status V4l2Camera::start() {
  if (failure_) return *failure_;
  if (buffers_) return Done{};
  auto done = set_up();
  if (!done) {
    buffers_.reset();
    if (done.error().code() == ErrorCode::kUnavailable) return fail(std::move(done).error());
  }
  return done;
}

Status V4l2Camera::set_up() {
  device_.subscribe_to_source_changes();
  TRY(device_.follow_signal());
  TRY_ASSIGN(format_, device_.set_format(offer_));
  TRY(device_.set_rate(options_.preferred.frames_per_second));
  TRY_ASSIGN(exposure_, set_exposure(device_, options_.exposure, options_.gain));
  auto buffers = StreamBuffers::start(device_.fd(), options_.memory);
  if (!buffers) return std::move(buffers).error().while_doing(fmt::format("camera at {}", device_.port()));
  buffers_.emplace(*std::move(buffers));
  last_kernel_sequence_.reset();
  pictures_since_gain_ = 0;
  damage_.clear();
  return Done{};
}

Result<bool> V4l2Camera::wait(TimePoint deadline) {
  for (;;) {
    pollfd asked{};
    asked.fd = device_.fd();
    asked.events = POLLIN | POLLPRI;
    const timespec timeout = timeout_until(deadline, clock_.now());
    const int ready = ::ppoll(&asked, 1, &timeout, nullptr);
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return fail(device_error(fmt::format("camera at {}: waiting for a picture", device_.port())));
    if (ready == 0) return false;
    if ((asked.revents & POLLPRI) != 0 && device_.took_source_change()) {
      return fail(Error(ErrorCode::kUnavailable,
                        fmt::format("camera at {}: its signal has another shape now", device_.port())));
    }
    // This includes POLLERR and POLLHUP, after which dequeuing a picture returns the error.
    if ((asked.revents & ~POLLPRI) != 0) return true;
  }
}

Result<V4l2Camera::Newest> V4l2Camera::take_newest() {
  Newest newest;
  std::size_t taken = 0;
  for (; taken < kMaxBuffersTaken; ++taken) {
    TRY_ASSIGN(const std::optional<FilledBuffer> filled, buffers_->take());
    if (!filled) break;
    if (filled->is_damaged || filled->bytes == 0) {
      damage_ = "it marks its pictures as damaged: a bad cable, or a bus without room";
      TRY(buffers_->give_back(*filled));
      continue;
    }
    if (newest.filled) TRY(buffers_->give_back(*newest.filled));
    newest.filled = filled;
  }
  newest.is_stale = taken >= buffers_->count();
  return newest;
}

Result<std::optional<FilledBuffer>> V4l2Camera::take_new(TimePoint deadline) {
  TRY_ASSIGN(const Newest first, take_newest());
  if (!first.filled || !first.is_stale) return first.filled;
  // Meanwhile the stale picture is kept as a fallback.
  TRY_ASSIGN(const bool is_ready, wait(deadline));
  if (!is_ready) return first.filled;
  TRY_ASSIGN(const Newest second, take_newest());
  if (!second.filled) return first.filled;
  TRY(buffers_->give_back(*first.filled));
  return second.filled;
}

Result<std::shared_ptr<const CameraFrame>> V4l2Camera::read(const FilledBuffer& filled) {
  auto frame = std::make_shared<CameraFrame>();
  const RawPicture raw{format_.layout,    format_.width,           format_.height,
                       format_.row_bytes, buffers_->bytes(filled), format_.colour};
  const bool wants_colour = options_.preferred.is_coloured && raw.colour.chroma != Chroma::kNone;
  buffers_->begin_reading(filled);
  Status is_read = to_grey(raw, &jpeg_, &frame->pixels);
  if (is_read && wants_colour) is_read = to_colour(raw, &jpeg_, &frame->colour);
  buffers_->end_reading(filled);
  TRY(is_read);
  // The driver counts in 32 bits, from 0 at each start; `sequence_` continues.
  const std::uint32_t step = last_kernel_sequence_ ? filled.sequence - *last_kernel_sequence_ : 1U;
  constexpr std::uint32_t kMaxStep = 1U << 16U;
  sequence_ += step == 0 || step > kMaxStep ? 1U : step;
  last_kernel_sequence_ = filled.sequence;
  frame->sequence = sequence_;
  frame->exposure = exposure_.exposure.value_or(Duration::zero());
  frame->captured_at = capture_time(filled.stamp, frame->exposure, clock_.now());
  return std::shared_ptr<const CameraFrame>(std::move(frame));
}

Result<std::shared_ptr<const CameraFrame>> V4l2Camera::next_frame(TimePoint deadline) {
  if (failure_) return *failure_;
  if (!buffers_) return Error(ErrorCode::kUnavailable, fmt::format("camera '{}' was not started", id_));
  do {
    TRY_ASSIGN(const bool is_ready, wait(deadline));
    if (!is_ready) break;
    auto newest = take_new(deadline);
    if (failure_) return *failure_;
    if (!newest) return fail(std::move(newest).error().while_doing(id_));
    if (!*newest) continue;
    auto frame = read(**newest);
    if (auto given = buffers_->give_back(**newest); !given) return fail(std::move(given).error().while_doing(id_));
    if (frame) {
      damage_.clear();
      follow_light((*frame)->pixels);
      return frame;
    }
    damage_ = frame.error().message();
  } while (clock_.now() < deadline);
  return Error(ErrorCode::kTimedOut, fmt::format("camera '{}': no picture before the deadline{}{}", id_,
                                                 damage_.empty() ? "" : "; ", damage_));
}

void V4l2Camera::follow_light(const GreyImage& picture) {
  if (!exposure_.gain || ++pictures_since_gain_ < kPicturesPerGain) return;
  pictures_since_gain_ = 0;
  const long gain = next_gain(exposure_.gain_now, bright_level(picture), *exposure_.gain);
  if (gain == exposure_.gain_now) return;
  // A device that is gone causes an error at the next picture; a device that refuses the value keeps its gain.
  static_cast<void>(device_.set_control(kGainControl, gain));
  exposure_.gain_now = gain;
}

}  // namespace cyclorama::camera
