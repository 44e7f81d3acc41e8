// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/scanout.h"

#include <fmt/format.h>

#include <array>

namespace cyclorama::output {
namespace {

/// GEM handle of another card's buffer on this card. The framebuffer keeps the pixels alive, so the handle is needed
/// only briefly.
class ImportedHandle {
 public:
  static Result<ImportedHandle> import(const Card& card, gbm_bo* buffer) {
    const UniqueFd shared(gbm_bo_get_fd(buffer));
    if (!shared.is_open()) return Error::from_errno("sharing a buffer between cards");
    ImportedHandle imported(card.fd());
    if (drmPrimeFDToHandle(card.fd(), shared.get(), &imported.handle_) != 0)
      return Error::from_errno(fmt::format("giving '{}' a buffer of the card that draws", card.path().string()));
    return imported;
  }
  ImportedHandle(ImportedHandle&& other) noexcept : fd_(other.fd_), handle_(std::exchange(other.handle_, 0)) {}
  ImportedHandle& operator=(ImportedHandle&&) = delete;
  ~ImportedHandle() {
    if (handle_ != 0) drmCloseBufferHandle(fd_, handle_);
  }
  [[nodiscard]] std::uint32_t get() const { return handle_; }

 private:
  explicit ImportedHandle(int fd) : fd_(fd) {}
  int fd_;
  std::uint32_t handle_ = 0;
};

Result<std::uint32_t> add_framebuffer(const Card& card, gbm_bo* buffer, std::uint32_t handle) {
  const std::array<std::uint32_t, 4> handles{handle, 0, 0, 0};
  const std::array<std::uint32_t, 4> strides{gbm_bo_get_stride(buffer), 0, 0, 0};
  const std::array<std::uint32_t, 4> offsets{};
  std::uint32_t id = 0;
  if (const int result =
          drmModeAddFB2(card.fd(), gbm_bo_get_width(buffer), gbm_bo_get_height(buffer), gbm_bo_get_format(buffer),
                        handles.data(), strides.data(), offsets.data(), &id, 0);
      result != 0)
    return kms_error(result, fmt::format("making a framebuffer on '{}'", card.path().string()));
  return id;
}

}  // namespace

Result<KmsFramebuffer> KmsFramebuffer::make(const GpuContext& gpu, const Card& card, gbm_bo* buffer) {
  KmsFramebuffer framebuffer;
  framebuffer.fd_ = card.fd();
  if (&card == &gpu.card()) {
    TRY_ASSIGN(framebuffer.id_, add_framebuffer(card, buffer, gbm_bo_get_handle(buffer).u32));
    return framebuffer;
  }
  TRY_ASSIGN(const ImportedHandle imported, ImportedHandle::import(card, buffer));
  TRY_ASSIGN(framebuffer.id_, add_framebuffer(card, buffer, imported.get()));
  return framebuffer;
}

Result<Scanout> Scanout::make(const GpuContext& gpu, const Card& card, int width_px, int height_px,
                              std::uint32_t format) {
  const Gl& gl = gpu.gl();
  Scanout scanout;
  TRY_ASSIGN(scanout.buffer_, gpu.make_buffer(width_px, height_px, format, &card != &gpu.card()));
  scanout.renderbuffer_ = GlRenderbuffer(gl);
  gl.BindRenderbuffer(GL_RENDERBUFFER, scanout.renderbuffer_.id());
  TRY_ASSIGN(scanout.image_, gpu.use_as_renderbuffer(scanout.buffer_.get()));
  scanout.gl_framebuffer_ = GlFramebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, scanout.gl_framebuffer_.id());
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, scanout.renderbuffer_.id());
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error(ErrorCode::kUnavailable, "the graphics driver cannot draw to what it scans out");
  TRY(gl.check("making a scan-out buffer"));
  TRY_ASSIGN(scanout.kms_framebuffer_, KmsFramebuffer::make(gpu, card, scanout.buffer_.get()));
  return scanout;
}

}  // namespace cyclorama::output
