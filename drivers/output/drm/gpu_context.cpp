// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/gpu_context.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

namespace cyclorama::output {
namespace {

Error drawing_failed(std::string_view step) {
  return Error(ErrorCode::kUnavailable, fmt::format("EGL on GBM: {}: EGL error 0x{:04x}", step, eglGetError()));
}

Error memory_failed(std::string_view step) {
  const int reason = errno;
  return Error(ErrorCode::kUnavailable, fmt::format("GBM: {}: {}", step, std::generic_category().message(reason)));
}

}  // namespace

Result<std::unique_ptr<GpuContext>> GpuContext::make(const Card& card) {
  std::unique_ptr<GpuContext> made(new GpuContext(card));
  if (auto opened = made->open(); !opened) return std::move(opened).error().while_doing(card.path().string());
  return made;
}

Status GpuContext::open() {
  gbm_ = gbm_create_device(card_.fd());
  if (gbm_ == nullptr) return memory_failed("opening the card's memory");
  display_ = eglGetPlatformDisplay(EGL_PLATFORM_GBM_KHR, gbm_, nullptr);
  if (display_ == EGL_NO_DISPLAY) return drawing_failed("no display on the card");
  if (eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) return drawing_failed("starting the display");
  if (eglBindAPI(EGL_OPENGL_ES_API) != EGL_TRUE) return drawing_failed("choosing OpenGL ES");
  TRY(make_context());
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
    return drawing_failed("using the context");
  TRY_ASSIGN(gl_, Gl::load([](const char* name) { return eglGetProcAddress(name); }));
  target_renderbuffer_ =
      reinterpret_cast<TargetRenderbuffer>(eglGetProcAddress("glEGLImageTargetRenderbufferStorageOES"));
  if (target_renderbuffer_ == nullptr)
    return Error(ErrorCode::kUnavailable, "the graphics driver has no glEGLImageTargetRenderbufferStorageOES");
  return Done{};
}

Status GpuContext::make_context() {
  const char* const extensions = eglQueryString(display_, EGL_EXTENSIONS);
  if (extensions == nullptr) return drawing_failed("reading EGL's extensions");
  const auto has = [&](std::string_view name) { return std::string_view(extensions).find(name) != std::string::npos; };
  const bool can_tell_resets = has("EGL_EXT_create_context_robustness");
  if (has("EGL_ANDROID_native_fence_sync"))
    dup_native_fence_ = reinterpret_cast<DupNativeFence>(eglGetProcAddress("eglDupNativeFenceFDANDROID"));
  constexpr std::array<EGLint, 3> kVersion3{EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  constexpr std::array<EGLint, 5> kVersion3ThatTells{EGL_CONTEXT_MAJOR_VERSION, 3,
                                                     EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT,
                                                     EGL_LOSE_CONTEXT_ON_RESET_EXT, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT,
                              can_tell_resets ? kVersion3ThatTells.data() : kVersion3.data());
  if (context_ == EGL_NO_CONTEXT) return drawing_failed("making an OpenGL ES 3.0 context");
  if (can_tell_resets) reset_status_ = reinterpret_cast<ResetStatus>(eglGetProcAddress("glGetGraphicsResetStatusEXT"));
  return Done{};
}

GpuContext::~GpuContext() {
  if (context_ != EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  if (display_ != EGL_NO_DISPLAY) eglTerminate(display_);
  eglReleaseThread();
  if (gbm_ != nullptr) gbm_device_destroy(gbm_);
}

bool GpuContext::is_lost() const { return reset_status_ != nullptr && reset_status_() != GL_NO_ERROR; }

std::optional<GpuFence> GpuContext::fence() const {
  if (dup_native_fence_ == nullptr) return std::nullopt;
  const EGLSync sync = eglCreateSync(display_, EGL_SYNC_NATIVE_FENCE_ANDROID, nullptr);
  if (sync == EGL_NO_SYNC) return std::nullopt;
  gl_.Flush();  // The fence has a file only once the commands before it were handed over.
  UniqueFd file(dup_native_fence_(display_, sync));
  eglDestroySync(display_, sync);
  if (!file.is_open()) return std::nullopt;
  return GpuFence(std::move(file));
}

Result<GbmBuffer> GpuContext::make_buffer(int width_px, int height_px, std::uint32_t format, bool is_shared) const {
  const std::uint32_t use =
      GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING | (is_shared ? static_cast<std::uint32_t>(GBM_BO_USE_LINEAR) : 0U);
  GbmBuffer buffer(
      gbm_bo_create(gbm_, static_cast<std::uint32_t>(width_px), static_cast<std::uint32_t>(height_px), format, use));
  if (buffer == nullptr) return memory_failed(fmt::format("making a buffer of {}x{} pixels", width_px, height_px));
  return buffer;
}

Result<EglImage> GpuContext::use_as_renderbuffer(gbm_bo* buffer) const {
  EglImage image(display_, eglCreateImage(display_, EGL_NO_CONTEXT, EGL_NATIVE_PIXMAP_KHR,
                                          reinterpret_cast<EGLClientBuffer>(buffer), nullptr));
  if (image.get() == EGL_NO_IMAGE) return drawing_failed("drawing to a buffer of the card");
  target_renderbuffer_(GL_RENDERBUFFER, image.get());
  return image;
}

}  // namespace cyclorama::output
