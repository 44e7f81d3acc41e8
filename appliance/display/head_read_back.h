// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/image/image.h"
#include "drivers/output/gl.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// Reads a drawn head back for a watcher without waiting for the graphics card: the card copies the pixels to a buffer
/// while further refreshes pass, and each later step converts a part of them, so that no refresh gets late for a
/// watcher. Move-only; thread-bound to the GL context, which it borrows. Allocates only when made.
class HeadReadBack {
 public:
  HeadReadBack(const output::Gl& gl, int width_px, int height_px);
  HeadReadBack(HeadReadBack&& other) noexcept;
  HeadReadBack& operator=(HeadReadBack&&) = delete;
  ~HeadReadBack();

  [[nodiscard]] bool is_reading() const { return picture_ != nullptr; }
  /// Begins to read the bound framebuffer into `picture`, which has the head's size. Precondition: !is_reading().
  void begin(std::unique_ptr<RgbImage> picture);
  /// Does a part of the work; returns the picture once it is complete, else null.
  std::unique_ptr<RgbImage> step();
  /// Ends a reading; returns its incomplete picture, null if there is none.
  std::unique_ptr<RgbImage> cancel();

 private:
  [[nodiscard]] std::size_t bytes() const;
  void convert_rows(const std::uint8_t* pixels);

  const output::Gl* gl_;
  output::GlBuffer buffer_;
  int width_px_;
  int height_px_;
  std::unique_ptr<RgbImage> picture_;  // Null while nothing is read.
  GLsync fence_ = nullptr;             // Behind the card's copy; null once that is complete.
  int rows_done_ = 0;
};

}  // namespace cyclorama::display
