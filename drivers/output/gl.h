// SPDX-License-Identifier: Apache-2.0
/// Function table of the OpenGL ES 3.0 calls that are used: EGL and OSMesa have separate implementations, and a process
/// may use both. Shaders are `#version 300 es` on both; OSMesa's desktop context accepts them by ARB_ES3_compatibility.
#pragma once

#define GL_GLES_PROTOTYPES 0  // No global gl* functions: a call that is not in the table does not compile.
#include <GLES3/gl3.h>

#include <functional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::output {

// clang-format off
#define CYCLORAMA_GL_CALLS(X) \
  X(PFNGLACTIVETEXTUREPROC, ActiveTexture) X(PFNGLATTACHSHADERPROC, AttachShader) \
  X(PFNGLBINDBUFFERPROC, BindBuffer) X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer) \
  X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer) X(PFNGLBINDTEXTUREPROC, BindTexture) \
  X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray) X(PFNGLBLENDCOLORPROC, BlendColor) \
  X(PFNGLBLENDFUNCPROC, BlendFunc) X(PFNGLBUFFERDATAPROC, BufferData) \
  X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus) X(PFNGLCLEARPROC, Clear) \
  X(PFNGLCLEARCOLORPROC, ClearColor) X(PFNGLCOMPILESHADERPROC, CompileShader) \
  X(PFNGLCREATEPROGRAMPROC, CreateProgram) X(PFNGLCREATESHADERPROC, CreateShader) \
  X(PFNGLDELETEBUFFERSPROC, DeleteBuffers) X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers) \
  X(PFNGLDELETEPROGRAMPROC, DeleteProgram) X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers) \
  X(PFNGLDELETESHADERPROC, DeleteShader) X(PFNGLDELETETEXTURESPROC, DeleteTextures) \
  X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays) X(PFNGLDISABLEPROC, Disable) \
  X(PFNGLDRAWARRAYSPROC, DrawArrays) X(PFNGLDRAWELEMENTSPROC, DrawElements) X(PFNGLENABLEPROC, Enable) \
  X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) X(PFNGLFINISHPROC, Finish) \
  X(PFNGLFLUSHPROC, Flush) X(PFNGLFENCESYNCPROC, FenceSync) X(PFNGLCLIENTWAITSYNCPROC, ClientWaitSync) \
  X(PFNGLDELETESYNCPROC, DeleteSync) X(PFNGLMAPBUFFERRANGEPROC, MapBufferRange) X(PFNGLUNMAPBUFFERPROC, UnmapBuffer) \
  X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) \
  X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D) X(PFNGLGENBUFFERSPROC, GenBuffers) \
  X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers) X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers) \
  X(PFNGLGENTEXTURESPROC, GenTextures) X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays) X(PFNGLGETERRORPROC, GetError) \
  X(PFNGLGETINTEGERVPROC, GetIntegerv) X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog) \
  X(PFNGLGETPROGRAMIVPROC, GetProgramiv) X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog) \
  X(PFNGLGETSHADERIVPROC, GetShaderiv) X(PFNGLGETSTRINGPROC, GetString) \
  X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation) X(PFNGLLINKPROGRAMPROC, LinkProgram) \
  X(PFNGLPIXELSTOREIPROC, PixelStorei) X(PFNGLREADPIXELSPROC, ReadPixels) \
  X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage) X(PFNGLSCISSORPROC, Scissor) \
  X(PFNGLSHADERSOURCEPROC, ShaderSource) \
  X(PFNGLTEXIMAGE2DPROC, TexImage2D) X(PFNGLTEXPARAMETERIPROC, TexParameteri) \
  X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D) X(PFNGLUNIFORM1FPROC, Uniform1f) X(PFNGLUNIFORM1IPROC, Uniform1i) \
  X(PFNGLUNIFORM2FPROC, Uniform2f) X(PFNGLUNIFORM3FPROC, Uniform3f) X(PFNGLUNIFORM4FPROC, Uniform4f) \
  X(PFNGLUNIFORMMATRIX3FVPROC, UniformMatrix3fv) X(PFNGLUSEPROGRAMPROC, UseProgram) \
  X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer) X(PFNGLVIEWPORTPROC, Viewport)
// clang-format on

/// `gl.Viewport(...)` is glViewport of the context for which the table was loaded. A value; use it on the thread on
/// which that context is current.
struct Gl {
#define CYCLORAMA_GL_MEMBER(type, name) type name = nullptr;
  CYCLORAMA_GL_CALLS(CYCLORAMA_GL_MEMBER)
#undef CYCLORAMA_GL_MEMBER

  using Procedure = void (*)();
  /// Errors: kUnavailable if the driver lacks a call or OpenGL ES 3.0; the message names what is missing.
  static Result<Gl> load(const std::function<Procedure(const char*)>& address_of);

  /// GL_RENDERER and GL_VERSION, such as "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL ES 3.2 Mesa 22.3.6".
  [[nodiscard]] std::string renderer() const;
  /// Errors: kSystem with the pending GL error, if any, and what was being done.
  [[nodiscard]] Status check(std::string_view doing) const;
};

}  // namespace cyclorama::output
