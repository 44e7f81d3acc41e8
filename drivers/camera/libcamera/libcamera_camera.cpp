// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/libcamera/libcamera_camera.h"

#include <fmt/format.h>
#include <linux/dma-buf.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "drivers/camera/capture_time.h"
#include "drivers/camera/libcamera/completed_requests.h"
#include "drivers/camera/libcamera/libcamera_versions.h"
#include "drivers/camera/libcamera/plane_map.h"

namespace cyclorama::camera {
namespace {

namespace lc = libcamera;

constexpr unsigned kBuffers = 4;

constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  std::uint32_t code = 0;
  for (unsigned i = 0; i < 4; ++i) code |= static_cast<std::uint32_t>(static_cast<unsigned char>(letters[i])) << 8U * i;
  return code;
}

/// Maps DRM formats, which libcamera uses instead of V4L2's; a modifier means packed bits, which are not supported.
std::optional<PixelLayout> layout_of(const lc::PixelFormat& format) {
  static const std::map<std::uint32_t, PixelLayout> kLayouts{
      {fourcc("R8  "), PixelLayout::kGrey8},     {fourcc("NV12"), PixelLayout::kPlanarYuv},
      {fourcc("NV21"), PixelLayout::kPlanarYuv}, {fourcc("NV16"), PixelLayout::kPlanarYuv},
      {fourcc("NV61"), PixelLayout::kPlanarYuv}, {fourcc("YU12"), PixelLayout::kPlanarYuv},
      {fourcc("YV12"), PixelLayout::kPlanarYuv}, {fourcc("YU16"), PixelLayout::kPlanarYuv},
      {fourcc("YV16"), PixelLayout::kPlanarYuv}, {fourcc("R10 "), PixelLayout::kGrey10},
      {fourcc("R12 "), PixelLayout::kGrey12},    {fourcc("R16 "), PixelLayout::kGrey16},
      {fourcc("YUYV"), PixelLayout::kYuyv},      {fourcc("YVYU"), PixelLayout::kYuyv},
      {fourcc("UYVY"), PixelLayout::kUyvy},      {fourcc("VYUY"), PixelLayout::kUyvy},
      {fourcc("MJPG"), PixelLayout::kJpeg}};
  const auto found = kLayouts.find(format.fourcc());
  if (format.modifier() != 0 || found == kLayouts.end()) return std::nullopt;
  return found->second;
}

/// Only the first plane is mapped, so colour is available only if that plane contains it.
ColourCode colour_of(const lc::StreamConfiguration& stream) {
  const std::uint32_t code = stream.pixelFormat.fourcc();
  if (code == fourcc("MJPG")) return {Chroma::kInJpeg, false, true};
  const bool is_v_first = code == fourcc("YVYU") || code == fourcc("VYUY");
  if (!is_v_first && code != fourcc("YUYV") && code != fourcc("UYVY")) return {};
  const bool is_full_range = stream.colorSpace && stream.colorSpace->range == lc::ColorSpace::Range::Full;
  return {Chroma::kBetween, is_v_first, is_full_range};
}

bool is_coloured(const lc::PixelFormat& format) {
  lc::StreamConfiguration stream;
  stream.pixelFormat = format;
  return colour_of(stream).chroma != Chroma::kNone;
}

/// Makes an error from libcamera's negative errno.
Error lc_error(int result, const std::string& doing) {
  errno = -result;
  Error error = Error::from_errno(doing);
  if (result == -EBUSY) return {ErrorCode::kBusy, error.message() + "; another program uses the camera"};
  if (result == -ENODEV || result == -ENXIO || result == -EIO || result == -EACCES) {
    return {ErrorCode::kUnavailable, error.message()};
  }
  return error;
}

/// Returns the process's only manager, which libcamera allows once; each camera keeps it alive.
Result<std::shared_ptr<lc::CameraManager>> the_manager() {
  static std::mutex mutex;
  static std::weak_ptr<lc::CameraManager> known;
  const std::lock_guard lock(mutex);
  if (auto manager = known.lock()) return manager;
  auto manager = std::make_shared<lc::CameraManager>();
  if (const int started = manager->start(); started != 0) {
    return Error(ErrorCode::kUnavailable, lc_error(started, "starting libcamera").message());
  }
  known = manager;
  return manager;
}

/// USB cameras are left to V4L2; their ids contain the bus name.
bool is_usb(const lc::Camera& camera) { return camera.id().find("usb") != std::string::npos; }

std::string model_of(const lc::Camera& camera) {
  const auto model = camera.properties().get(lc::properties::Model);
  return model ? std::string(*model) : camera.id();
}

/// Returns the formats and sizes that the camera can send; their rates are unknown, since libcamera reports none.
std::vector<PictureOffer> offers_of(const lc::StreamConfiguration& stream, const PicturePreference& preferred) {
  std::vector<PictureOffer> offers;
  for (const lc::PixelFormat& format : stream.formats().pixelformats()) {
    const auto layout = layout_of(format);
    if (!layout) continue;
    const auto add = [&](const lc::Size& size) {
      offers.push_back({format.fourcc(), *layout, static_cast<int>(size.width), static_cast<int>(size.height), 0.0,
                        is_coloured(format)});
    };
    const std::vector<lc::Size> sizes = stream.formats().sizes(format);
    for (const lc::Size& size : sizes) add(size);
    const lc::Size requested(static_cast<unsigned>(preferred.width_px), static_cast<unsigned>(preferred.height_px));
    // A camera with a scaler lists a few sizes and accepts any size in the range.
    if (const lc::SizeRange range = stream.formats().range(format); sizes.empty() || range.contains(requested))
      add(requested);
  }
  return offers;
}

class LibcameraCamera final : public Camera {
 public:
  LibcameraCamera(std::shared_ptr<lc::CameraManager> manager, std::shared_ptr<lc::Camera> camera,
                  LibcameraOptions options, const Clock& clock)
      : id_("libcamera:" + camera->id()),
        manager_(std::move(manager)),
        camera_(std::move(camera)),
        options_(options),
        clock_(clock) {
    camera_->requestCompleted.connect(this, &LibcameraCamera::on_completed);
    camera_->disconnected.connect(this, &LibcameraCamera::on_disconnected);
  }
  ~LibcameraCamera() override {
    stop();
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
  }

  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override;
  Result<std::shared_ptr<const CameraFrame>> next_frame(TimePoint deadline) override;
  void stop() override;

 private:
  // Called on libcamera's thread.
  void on_completed(lc::Request* request) {
    if (request->status() != lc::Request::RequestCancelled) completed_.put(request);
  }
  void on_disconnected() { completed_.end(); }

  Status set_up();
  Status configure();
  Status make_requests();
  Status queue_again(lc::Request* request);
  /// Requeues all requests but the newest and waits for a later picture. Called when all requests are completed: the
  /// camera has then stopped, and its newest picture is stale.
  Status await_new(TimePoint deadline, std::vector<lc::Request*>* completed);
  Result<std::shared_ptr<const CameraFrame>> read(lc::Request& request);
  [[nodiscard]] Error unplugged() const {
    return {ErrorCode::kUnavailable, fmt::format("camera '{}' is gone (unplugged?)", id_)};
  }

  std::string id_;
  std::shared_ptr<lc::CameraManager> manager_;
  std::shared_ptr<lc::Camera> camera_;
  LibcameraOptions options_;
  const Clock& clock_;
  bool is_acquired_ = false;
  bool is_running_ = false;
  std::unique_ptr<lc::CameraConfiguration> configuration_;
  std::unique_ptr<lc::FrameBufferAllocator> allocator_;
  std::map<const lc::FrameBuffer*, PlaneMap> maps_;
  std::vector<std::unique_ptr<lc::Request>> requests_;
  CompletedRequests<lc::Request> completed_;
  PixelLayout layout_ = PixelLayout::kGrey8;
  ColourCode colour_{};
  JpegDecoder jpeg_;
  std::uint64_t sequence_ = 0;
  std::optional<unsigned> last_sequence_;
  std::optional<Error> failure_;
};

Status LibcameraCamera::start() {
  if (failure_) return *failure_;
  if (is_running_) return Done{};
  auto done = set_up();
  if (!done) stop();
  return done;
}

Status LibcameraCamera::set_up() {
  if (completed_.has_ended()) return unplugged();
  if (const int taken = camera_->acquire(); taken != 0) return lc_error(taken, fmt::format("taking camera '{}'", id_));
  is_acquired_ = true;
  TRY(configure());
  TRY(make_requests());
  lc::ControlList controls(camera_->controls());
  if (options_.exposure > Duration::zero()) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(options_.exposure).count();
    fix_exposure(camera_->controls(), static_cast<std::int32_t>(us), &controls);
  }
  // A calibration compares colours between pictures, and a change of focus changes the intrinsics.
  if (options_.preferred.is_coloured && camera_->controls().count(&lc::controls::AfMode) != 0) {
    controls.set(lc::controls::AfMode, static_cast<std::int32_t>(lc::controls::AfModeManual));
  }
  if (options_.preferred.is_coloured && camera_->controls().count(&lc::controls::AwbEnable) != 0) {
    controls.set(lc::controls::AwbEnable, false);
  }
  if (camera_->controls().count(&lc::controls::FrameDurationLimits) != 0) {
    const auto period_us = static_cast<std::int64_t>(1e6 / options_.preferred.frames_per_second);
    controls.set(lc::controls::FrameDurationLimits, lc::Span<const std::int64_t, 2>({period_us, period_us}));
  }
  if (const int started = camera_->start(&controls); started != 0) {
    return lc_error(started, fmt::format("starting camera '{}'", id_));
  }
  is_running_ = true;
  for (const auto& request : requests_) {
    if (const int queued = camera_->queueRequest(request.get()); queued != 0) {
      return lc_error(queued, fmt::format("requesting a picture of camera '{}'", id_));
    }
  }
  return Done{};
}

Status LibcameraCamera::configure() {
  configuration_ = viewfinder_of(camera_.get());
  if (configuration_ == nullptr || configuration_->empty()) {
    return Error(ErrorCode::kSystem, fmt::format("camera '{}' has no viewfinder stream", id_));
  }
  lc::StreamConfiguration& stream = configuration_->at(0);
  const std::vector<PictureOffer> offers = offers_of(stream, options_.preferred);
  TRY_ASSIGN(const std::size_t chosen, choose_picture(offers, options_.preferred));
  stream.pixelFormat = lc::PixelFormat(offers[chosen].fourcc);
  stream.size = {static_cast<unsigned>(offers[chosen].width_px), static_cast<unsigned>(offers[chosen].height_px)};
  stream.bufferCount = kBuffers;
  const auto status = configuration_->validate();
  const auto layout = layout_of(stream.pixelFormat);
  if (status == lc::CameraConfiguration::Invalid || !layout) {
    return Error(ErrorCode::kSystem, fmt::format("camera '{}' does not take {}", id_, describe(offers[chosen])));
  }
  layout_ = *layout;
  if (options_.preferred.is_coloured) colour_ = colour_of(stream);
  if (const int done = camera_->configure(configuration_.get()); done != 0) {
    return lc_error(done, fmt::format("configuring camera '{}'", id_));
  }
  return Done{};
}

Status LibcameraCamera::make_requests() {
  lc::Stream* const stream = configuration_->at(0).stream();
  allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
  if (const int count = allocator_->allocate(stream); count < 0) {
    return lc_error(count, fmt::format("memory for camera '{}'", id_));
  }
  for (const std::unique_ptr<lc::FrameBuffer>& buffer : allocator_->buffers(stream)) {
    // Brightness is always in the first plane.
    const lc::FrameBuffer::Plane& plane = buffer->planes().front();
    TRY_ASSIGN(PlaneMap map, PlaneMap::map(plane.fd.get(), plane.offset, plane.length));
    maps_.emplace(buffer.get(), std::move(map));
    std::unique_ptr<lc::Request> request = camera_->createRequest();
    if (request == nullptr) return unplugged();
    if (const int added = request->addBuffer(stream, buffer.get()); added != 0) {
      return lc_error(added, fmt::format("a request of camera '{}'", id_));
    }
    requests_.push_back(std::move(request));
  }
  return Done{};
}

void LibcameraCamera::stop() {
  if (is_running_) camera_->stop();
  is_running_ = false;
  completed_.clear();
  requests_.clear();
  maps_.clear();
  allocator_.reset();
  configuration_.reset();
  last_sequence_.reset();
  if (is_acquired_) camera_->release();
  is_acquired_ = false;
}

Status LibcameraCamera::queue_again(lc::Request* request) {
  request->reuse(lc::Request::ReuseBuffers);
  if (const int queued = camera_->queueRequest(request); queued != 0) {
    return lc_error(queued, fmt::format("requesting a picture of camera '{}'", id_));
  }
  return Done{};
}

Result<std::shared_ptr<const CameraFrame>> LibcameraCamera::next_frame(TimePoint deadline) {
  if (failure_) return *failure_;
  if (!is_running_) return Error(ErrorCode::kUnavailable, fmt::format("camera '{}' was not started", id_));
  std::string damage;
  do {
    std::vector<lc::Request*> completed = completed_.take_before(deadline);
    std::optional<Error> lost;
    if (completed.size() == requests_.size()) {
      if (auto waited = await_new(deadline, &completed); !waited) lost = waited.error();
    }
    if (completed_.has_ended()) lost = unplugged();
    // Takes the newest undamaged picture, or its error if there is none.
    Result<std::shared_ptr<const CameraFrame>> frame = Error(ErrorCode::kTimedOut, "");
    for (auto request = completed.rbegin(); request != completed.rend() && !lost; ++request) {
      if (!frame) frame = read(**request);
      if (auto queued = queue_again(*request); !queued) lost = queued.error();
    }
    if (lost) {
      stop();
      failure_ = Error(ErrorCode::kUnavailable, lost->message());
      return *failure_;
    }
    if (frame) return frame;
    damage = frame.error().message();
  } while (clock_.now() < deadline);
  return Error(ErrorCode::kTimedOut,
               fmt::format("camera '{}': no picture before the deadline{}{}", id_, damage.empty() ? "" : "; ", damage));
}

Status LibcameraCamera::await_new(TimePoint deadline, std::vector<lc::Request*>* completed) {
  while (completed->size() > 1) {
    TRY(queue_again(completed->front()));
    completed->erase(completed->begin());
  }
  const std::vector<lc::Request*> newer = completed_.take_before(deadline);
  completed->insert(completed->end(), newer.begin(), newer.end());
  return Done{};
}

Result<std::shared_ptr<const CameraFrame>> LibcameraCamera::read(lc::Request& request) {
  const lc::FrameBuffer* const buffer = request.buffers().begin()->second;
  const lc::FrameMetadata& metadata = buffer->metadata();
  if (metadata.status != lc::FrameMetadata::FrameSuccess) return Error(ErrorCode::kBadData, "its pictures are damaged");
  const lc::StreamConfiguration& stream = configuration_->at(0);
  std::span<const std::byte> bytes = maps_.at(buffer).bytes();
  if (layout_ == PixelLayout::kJpeg)
    bytes = bytes.first(std::min<std::size_t>(bytes.size(), metadata.planes()[0].bytesused));
  const RawPicture raw{
      layout_, static_cast<int>(stream.size.width), static_cast<int>(stream.size.height), stream.stride, bytes,
      colour_};
  auto frame = std::make_shared<CameraFrame>();
  dma_buf_sync sync{};
  const int dma_buf = buffer->planes().front().fd.get();
  sync.flags = DMA_BUF_SYNC_READ | DMA_BUF_SYNC_START;
  static_cast<void>(::ioctl(dma_buf, DMA_BUF_IOCTL_SYNC, &sync));
  Status is_read = to_grey(raw, &jpeg_, &frame->pixels);
  if (is_read && colour_.chroma != Chroma::kNone) is_read = to_colour(raw, &jpeg_, &frame->colour);
  sync.flags = DMA_BUF_SYNC_READ | DMA_BUF_SYNC_END;
  static_cast<void>(::ioctl(dma_buf, DMA_BUF_IOCTL_SYNC, &sync));
  TRY(is_read);
  const unsigned step = last_sequence_ ? metadata.sequence - *last_sequence_ : 1U;
  sequence_ += std::clamp(step, 1U, 1U << 16U);
  last_sequence_ = metadata.sequence;
  frame->sequence = sequence_;
  // SensorTimestamp is on CLOCK_BOOTTIME, which equals CLOCK_MONOTONIC as long as the machine never suspends, as in a
  // museum.
  const auto sensor_ns = request.metadata().get(lc::controls::SensorTimestamp);
  KernelStamp stamp{true, sensor_ns.has_value(), from_nanoseconds(static_cast<std::int64_t>(metadata.timestamp))};
  if (sensor_ns) stamp.at = from_nanoseconds(*sensor_ns);
  frame->captured_at = capture_time(stamp, options_.exposure, clock_.now());
  if (const auto exposed_us = request.metadata().get(lc::controls::ExposureTime); exposed_us) {
    frame->exposure = std::chrono::microseconds(*exposed_us);
  }
  return std::shared_ptr<const CameraFrame>(std::move(frame));
}

}  // namespace

Result<std::unique_ptr<Camera>> open_libcamera_camera(std::string_view id, const LibcameraOptions& options,
                                                      const Clock& clock) {
  TRY_ASSIGN(std::shared_ptr<lc::CameraManager> manager, the_manager());
  std::string others;
  for (const std::shared_ptr<lc::Camera>& camera : manager->cameras()) {
    if (id.empty() ? !is_usb(*camera) : camera->id() == id) {
      return std::unique_ptr<Camera>(std::make_unique<LibcameraCamera>(manager, camera, options, clock));
    }
    others += fmt::format("{}{}", others.empty() ? "" : ", ", camera->id());
  }
  return Error(ErrorCode::kNotFound,
               fmt::format("libcamera knows no camera {}; there {}", id.empty() ? "but V4L2's" : id,
                           others.empty() ? "is none" : "are " + others));
}

std::vector<ListedCamera> list_libcamera_cameras() {
  auto manager = the_manager();
  if (!manager) return {};
  std::vector<ListedCamera> cameras;
  for (const std::shared_ptr<lc::Camera>& camera : (*manager)->cameras()) {
    if (is_usb(*camera)) continue;
    cameras.push_back({"libcamera:" + camera->id(), model_of(*camera), camera->id(), "", ""});
  }
  return cameras;
}

}  // namespace cyclorama::camera
