// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <gbm.h>

#include <memory>

#include "drivers/output/drm/card.h"
#include "drivers/output/drm/gpu_fence.h"
#include "drivers/output/drm/kms.h"
#include "drivers/output/gl.h"

namespace cyclorama::output {

using GbmBuffer = std::unique_ptr<gbm_bo, KmsFree<gbm_bo_destroy>>;

/// A GBM buffer imported into EGL. Move-only.
class EglImage {
 public:
  EglImage() = default;
  EglImage(EGLDisplay display, EGLImage image) : display_(display), image_(image) {}
  EglImage(EglImage&& other) noexcept : display_(other.display_), image_(std::exchange(other.image_, EGL_NO_IMAGE)) {}
  EglImage& operator=(EglImage&& other) noexcept {
    std::swap(display_, other.display_);
    std::swap(image_, other.image_);
    return *this;
  }
  ~EglImage() {
    if (image_ != EGL_NO_IMAGE) eglDestroyImage(display_, image_);
  }
  [[nodiscard]] EGLImage get() const { return image_; }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLImage image_ = EGL_NO_IMAGE;
};

/// OpenGL ES 3 on a card's own renderer (GBM). It is current on the thread that made it, and must be destroyed on that
/// thread. Borrows the card, which must outlive it. Thread-bound.
class GpuContext {
 public:
  /// Errors: kUnavailable if the driver does not support it; the message names the step that failed.
  static Result<std::unique_ptr<GpuContext>> make(const Card& card);
  ~GpuContext();
  GpuContext(const GpuContext&) = delete;
  GpuContext& operator=(const GpuContext&) = delete;

  [[nodiscard]] const Gl& gl() const { return gl_; }
  [[nodiscard]] const Card& card() const { return card_; }
  /// True once the GPU has been reset, which destroys the contents of the context.
  [[nodiscard]] bool is_lost() const;
  /// Returns a fence behind all commands so far, and flushes them; nothing if the driver has no such fences, or fails.
  [[nodiscard]] std::optional<GpuFence> fence() const;

  /// Makes a buffer for rendering and scan-out; if `is_shared`, another card can scan it out. Errors: kUnavailable if
  /// there is no memory or no such format.
  [[nodiscard]] Result<GbmBuffer> make_buffer(int width_px, int height_px, std::uint32_t format, bool is_shared) const;
  /// Uses the buffer as storage of the bound renderbuffer. The buffer must outlive the image. Errors: kUnavailable with
  /// EGL's error.
  [[nodiscard]] Result<EglImage> use_as_renderbuffer(gbm_bo* buffer) const;

 private:
  explicit GpuContext(const Card& card) : card_(card) {}
  Status open();
  Status make_context();

  using TargetRenderbuffer = void (*)(GLenum target, EGLImage image);
  using ResetStatus = GLenum (*)();
  using DupNativeFence = EGLint (*)(EGLDisplay display, EGLSync sync);

  const Card& card_;
  gbm_device* gbm_ = nullptr;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  TargetRenderbuffer target_renderbuffer_ = nullptr;
  DupNativeFence dup_native_fence_ = nullptr;  // Null if the driver has no EGL_ANDROID_native_fence_sync.
  ResetStatus reset_status_ = nullptr;  // Null if the driver does not support reset notification.
  Gl gl_;
};

}  // namespace cyclorama::output
