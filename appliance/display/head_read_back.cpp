// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_read_back.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::display {
namespace {

constexpr int kPixelsPerStep = 1 << 18;  // A fraction of a millisecond; a full HD head takes eight refreshes.
constexpr int kChannels = 4;

}  // namespace

HeadReadBack::HeadReadBack(const output::Gl& gl, int width_px, int height_px)
    : gl_(&gl), buffer_(gl), width_px_(width_px), height_px_(height_px) {
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.id());
  gl.BufferData(GL_PIXEL_PACK_BUFFER, static_cast<GLsizeiptr>(bytes()), nullptr, GL_STREAM_READ);
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

HeadReadBack::HeadReadBack(HeadReadBack&& other) noexcept
    : gl_(other.gl_),
      buffer_(std::move(other.buffer_)),
      width_px_(other.width_px_),
      height_px_(other.height_px_),
      picture_(std::move(other.picture_)),
      fence_(std::exchange(other.fence_, nullptr)),
      rows_done_(other.rows_done_) {}

HeadReadBack::~HeadReadBack() { cancel(); }

std::size_t HeadReadBack::bytes() const {
  return static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_) * kChannels;
}

void HeadReadBack::begin(std::unique_ptr<RgbImage> picture) {
  CHECK(!is_reading() && picture != nullptr);
  CHECK(picture->width() == width_px_ && picture->height() == height_px_);
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.id());
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_->ReadPixels(0, 0, width_px_, height_px_, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  fence_ = gl_->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  picture_ = std::move(picture);
  rows_done_ = 0;
}

std::unique_ptr<RgbImage> HeadReadBack::step() {
  if (!is_reading()) return nullptr;
  if (fence_ != nullptr) {
    if (gl_->ClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, 0) == GL_TIMEOUT_EXPIRED) return nullptr;
    gl_->DeleteSync(std::exchange(fence_, nullptr));
  }
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.id());
  const void* const pixels =
      gl_->MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, static_cast<GLsizeiptr>(bytes()), GL_MAP_READ_BIT);
  if (pixels != nullptr) {
    convert_rows(static_cast<const std::uint8_t*>(pixels));
    gl_->UnmapBuffer(GL_PIXEL_PACK_BUFFER);
  }
  gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  return rows_done_ < height_px_ ? nullptr : std::move(picture_);
}

/// The card's rows count from the bottom.
void HeadReadBack::convert_rows(const std::uint8_t* pixels) {
  const int end = std::min(height_px_, rows_done_ + std::max(1, kPixelsPerStep / width_px_));
  for (; rows_done_ < end; ++rows_done_) {
    const auto row = static_cast<std::size_t>(height_px_ - 1 - rows_done_);
    const std::uint8_t* from = pixels + row * static_cast<std::size_t>(width_px_) * kChannels;
    std::uint8_t* to = picture_->at(0, rows_done_);
    for (int x = 0; x < width_px_; ++x, from += kChannels, to += 3) std::memcpy(to, from, 3);
  }
}

std::unique_ptr<RgbImage> HeadReadBack::cancel() {
  if (fence_ != nullptr) gl_->DeleteSync(std::exchange(fence_, nullptr));
  return std::move(picture_);
}

}  // namespace cyclorama::display
