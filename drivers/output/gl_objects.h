// SPDX-License-Identifier: Apache-2.0
/// Owners of GL object names. Each must be destroyed on the thread of its context, before the context is.
#pragma once

#include <utility>

#include "common/image/image.h"
#include "drivers/output/gl.h"

namespace cyclorama::output {

/// Owns one GL name; 0 is empty. Move-only. Borrows the Gl table, which must outlive it. Thread-bound.
template <auto Gl::*Generate, auto Gl::*Delete>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(const Gl& gl) : gl_(&gl) { (gl.*Generate)(1, &id_); }
  GlObject(GlObject&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlObject() {
    if (id_ != 0) (gl_->*Delete)(1, &id_);
  }
  [[nodiscard]] GLuint id() const { return id_; }

 private:
  const Gl* gl_ = nullptr;
  GLuint id_ = 0;
};

using GlTexture = GlObject<&Gl::GenTextures, &Gl::DeleteTextures>;
using GlBuffer = GlObject<&Gl::GenBuffers, &Gl::DeleteBuffers>;
using GlVertexArray = GlObject<&Gl::GenVertexArrays, &Gl::DeleteVertexArrays>;
using GlFramebuffer = GlObject<&Gl::GenFramebuffers, &Gl::DeleteFramebuffers>;
using GlRenderbuffer = GlObject<&Gl::GenRenderbuffers, &Gl::DeleteRenderbuffers>;

/// A linked program. Move-only, with the same rules as GlObject.
class GlProgram {
 public:
  /// Errors: kSystem with the log of the compiler or linker.
  static Result<GlProgram> link(const Gl& gl, const char* vertex_source, const char* fragment_source);
  GlProgram(GlProgram&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
  GlProgram& operator=(GlProgram&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlProgram() {
    if (id_ != 0) gl_->DeleteProgram(id_);
  }
  [[nodiscard]] GLuint id() const { return id_; }
  [[nodiscard]] GLint uniform(const char* name) const { return gl_->GetUniformLocation(id_, name); }

 private:
  GlProgram(const Gl& gl, GLuint id) : gl_(&gl), id_(id) {}
  const Gl* gl_;
  GLuint id_;
};

/// Converts the result of glReadPixels (rows from the bottom, four channels) to a picture of the same size.
void to_picture(const RgbaImage& read_back, RgbImage* ret_picture);

}  // namespace cyclorama::output
