// SPDX-License-Identifier: Apache-2.0
// GBM, EGL on GBM and udev, implemented by the FakeMachine. GL itself is the machine's, without a surface. The pixels
// of a buffer are those of the renderbuffer that it backs.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <drm_fourcc.h>
#include <gbm.h>
#include <libudev.h>
#include <sys/eventfd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/output/gl.h"
#include "tests/doubles/fake_card/fake_machine.h"

using cyclorama::FakeMachine;

struct gbm_device {
  int fd;
};
struct udev {};
struct udev_monitor {};
struct udev_device {};

// The linker demands these names (--wrap).
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
EGLDisplay __real_eglGetPlatformDisplay(EGLenum platform, void* native, const EGLAttrib* attributes);
EGLBoolean __real_eglInitialize(EGLDisplay display, EGLint* major, EGLint* minor);
EGLBoolean __real_eglBindAPI(EGLenum api);
EGLContext __real_eglCreateContext(EGLDisplay display, EGLConfig config, EGLContext share, const EGLint* attributes);
EGLBoolean __real_eglDestroyContext(EGLDisplay display, EGLContext context);
EGLBoolean __real_eglMakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context);
const char* __real_eglQueryString(EGLDisplay display, EGLint name);
cyclorama::output::Gl::Procedure __real_eglGetProcAddress(const char* name);
}

namespace {

FakeMachine& machine() { return FakeMachine::the(); }

bool fails(const char* call) {
  const int error = machine().meet(call);
  if (error != 0) errno = error;
  return error != 0;
}

cyclorama::output::Gl real_gl() {
  auto gl = cyclorama::output::Gl::load([](const char* name) { return __real_eglGetProcAddress(name); });
  return *gl;
}

/// Replaces glEGLImageTargetRenderbufferStorageOES(). An image is represented by its buffer.
void give_storage(GLenum, void* image) {
  auto* const buffer = static_cast<gbm_bo*>(image);
  const cyclorama::output::Gl gl = real_gl();
  GLint bound = 0;
  gl.GetIntegerv(GL_RENDERBUFFER_BINDING, &bound);
  buffer->renderbuffer = static_cast<GLuint>(bound);
  gl.RenderbufferStorage(GL_RENDERBUFFER, buffer->format == DRM_FORMAT_XRGB2101010 ? GL_RGB10_A2 : GL_RGBA8,
                         static_cast<GLsizei>(buffer->width), static_cast<GLsizei>(buffer->height));
}

GLenum reset_status() {
  constexpr GLenum kGuiltyContextReset = 0x8253;
  return machine().is_gpu_reset ? kGuiltyContextReset : GLenum{GL_NO_ERROR};
}

/// Replaces glFinish(), which waits for the simulated GPU too.
void finish() {
  __real_eglGetProcAddress("glFinish")();
  if (fails("glFinish")) return;
  machine().flush_gpu();
  machine().spend(machine().rendered_at - machine().clock().now());
}

/// Replaces eglDupNativeFenceFDANDROID().
EGLint make_fence_file(EGLDisplay, EGLSync) {
  if (fails("eglDupNativeFenceFDANDROID")) return -1;
  const int fd = ::eventfd(0, EFD_CLOEXEC);
  machine().fences[fd] = machine().rendered_at;
  return fd;
}

template <typename Object>
Object* made(const char* call) {
  if (fails(call)) return nullptr;
  ++machine().udev_objects;
  return new Object;
}
template <typename Object>
Object* freed(Object* object) {
  if (object != nullptr) --machine().udev_objects;
  delete object;
  return nullptr;
}

}  // namespace

namespace cyclorama {

RgbImage read_buffer(const gbm_bo& buffer) {
  const output::Gl gl = real_gl();
  GLint bound = 0;
  gl.GetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  GLuint reader = 0;
  gl.GenFramebuffers(1, &reader);
  gl.BindFramebuffer(GL_FRAMEBUFFER, reader);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffer.renderbuffer);
  RgbaImage pixels(static_cast<int>(buffer.width), static_cast<int>(buffer.height));
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, pixels.width(), pixels.height(), GL_RGBA, GL_UNSIGNED_BYTE, pixels.data().data());
  gl.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
  gl.DeleteFramebuffers(1, &reader);
  // A card scans memory out from its first row, which is row 0 in GL.
  RgbImage picture(pixels.width(), pixels.height());
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) std::memcpy(picture.at(x, y), pixels.at(x, y), 3);
  }
  return picture;
}

}  // namespace cyclorama

extern "C" {

gbm_device* __wrap_gbm_create_device(int fd) {
  if (fails("gbm_create_device")) return nullptr;
  ++machine().gbm_devices;
  return new gbm_device{fd};
}
void __wrap_gbm_device_destroy(gbm_device* device) {
  --machine().gbm_devices;
  delete device;
}
gbm_bo* __wrap_gbm_bo_create(gbm_device*, std::uint32_t width, std::uint32_t height, std::uint32_t format,
                             std::uint32_t) {
  if (fails("gbm_bo_create")) return nullptr;
  auto* const buffer = new gbm_bo{width, height, format, machine().next_id(), 0};
  machine().buffers.insert(buffer);
  return buffer;
}
void __wrap_gbm_bo_destroy(gbm_bo* buffer) {
  machine().buffers.erase(buffer);
  delete buffer;
}
std::uint32_t __wrap_gbm_bo_get_width(gbm_bo* buffer) { return buffer->width; }
std::uint32_t __wrap_gbm_bo_get_height(gbm_bo* buffer) { return buffer->height; }
std::uint32_t __wrap_gbm_bo_get_stride(gbm_bo* buffer) { return 4 * buffer->width; }
std::uint32_t __wrap_gbm_bo_get_format(gbm_bo* buffer) { return buffer->format; }
gbm_bo_handle __wrap_gbm_bo_get_handle(gbm_bo* buffer) {
  gbm_bo_handle handle{};
  handle.u32 = buffer->handle;
  return handle;
}
int __wrap_gbm_bo_get_fd(gbm_bo* buffer) {
  if (fails("gbm_bo_get_fd")) return -1;
  const int fd = ::eventfd(0, EFD_CLOEXEC);
  machine().shared[fd] = buffer;
  return fd;
}

EGLDisplay __wrap_eglGetPlatformDisplay(EGLenum platform, void* native, const EGLAttrib* attributes) {
  if (platform != EGL_PLATFORM_GBM_KHR) return __real_eglGetPlatformDisplay(platform, native, attributes);
  if (fails("eglGetPlatformDisplay")) return EGL_NO_DISPLAY;
  return __real_eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}
EGLBoolean __wrap_eglInitialize(EGLDisplay display, EGLint* major, EGLint* minor) {
  return fails("eglInitialize") ? EGLBoolean{EGL_FALSE} : __real_eglInitialize(display, major, minor);
}
// Does nothing, because the process has only one surfaceless display, which others may use.
EGLBoolean __wrap_eglTerminate(EGLDisplay) { return EGL_TRUE; }
EGLBoolean __wrap_eglBindAPI(EGLenum api) {
  return fails("eglBindAPI") ? EGLBoolean{EGL_FALSE} : __real_eglBindAPI(api);
}
const char* __wrap_eglQueryString(EGLDisplay display, EGLint name) {
  if (fails("eglQueryString")) return nullptr;
  if (name != EGL_EXTENSIONS) return __real_eglQueryString(display, name);
  return machine().has_fences() ? "EGL_KHR_image_base EGL_EXT_create_context_robustness EGL_ANDROID_native_fence_sync"
                                : "EGL_KHR_image_base EGL_EXT_create_context_robustness";
}
EGLContext __wrap_eglCreateContext(EGLDisplay display, EGLConfig config, EGLContext share, const EGLint*) {
  if (fails("eglCreateContext")) return EGL_NO_CONTEXT;
  constexpr std::array<EGLint, 3> kVersion3{EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  ++machine().contexts;
  machine().is_gpu_reset = false;
  return __real_eglCreateContext(display, config, share, kVersion3.data());
}
EGLBoolean __wrap_eglDestroyContext(EGLDisplay display, EGLContext context) {
  --machine().contexts;
  return __real_eglDestroyContext(display, context);
}
EGLBoolean __wrap_eglMakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context) {
  // Releasing a context never fails.
  if (context != EGL_NO_CONTEXT && fails("eglMakeCurrent")) return EGL_FALSE;
  return __real_eglMakeCurrent(display, draw, read, context);
}
cyclorama::output::Gl::Procedure __wrap_eglGetProcAddress(const char* name) {
  if (fails("eglGetProcAddress")) return nullptr;
  const std::string wanted = name;
  if (wanted == "glEGLImageTargetRenderbufferStorageOES")
    return reinterpret_cast<cyclorama::output::Gl::Procedure>(&give_storage);
  if (wanted == "glGetGraphicsResetStatusEXT") return reinterpret_cast<cyclorama::output::Gl::Procedure>(&reset_status);
  if (wanted == "glFinish") return &finish;
  if (wanted == "eglDupNativeFenceFDANDROID")
    return reinterpret_cast<cyclorama::output::Gl::Procedure>(&make_fence_file);
  return __real_eglGetProcAddress(name);
}
EGLSync __wrap_eglCreateSync(EGLDisplay, EGLenum, const EGLAttrib*) {
  if (fails("eglCreateSync")) return EGL_NO_SYNC;
  machine().flush_gpu();
  return &machine();
}
EGLBoolean __wrap_eglDestroySync(EGLDisplay, EGLSync) { return EGL_TRUE; }
EGLImage __wrap_eglCreateImage(EGLDisplay, EGLContext, EGLenum, EGLClientBuffer buffer, const EGLAttrib*) {
  if (fails("eglCreateImage")) return EGL_NO_IMAGE;
  ++machine().images;
  return buffer;
}
EGLBoolean __wrap_eglDestroyImage(EGLDisplay, EGLImage) {
  --machine().images;
  return fails("eglDestroyImage") ? EGL_FALSE : EGL_TRUE;
}

udev* __wrap_udev_new() { return made<udev>("udev_new"); }
udev* __wrap_udev_unref(udev* context) { return freed(context); }
udev_monitor* __wrap_udev_monitor_new_from_netlink(udev*, const char*) {
  return made<udev_monitor>("udev_monitor_new_from_netlink");
}
udev_monitor* __wrap_udev_monitor_unref(udev_monitor* monitor) { return freed(monitor); }
int __wrap_udev_monitor_filter_add_match_subsystem_devtype(udev_monitor*, const char*, const char*) {
  return -machine().meet("udev_monitor_filter_add_match_subsystem_devtype");
}
int __wrap_udev_monitor_enable_receiving(udev_monitor*) { return -machine().meet("udev_monitor_enable_receiving"); }
udev_device* __wrap_udev_monitor_receive_device(udev_monitor*) {
  if (machine().hot_plugs == 0) return nullptr;
  --machine().hot_plugs;
  return made<udev_device>("udev_monitor_receive_device");
}
udev_device* __wrap_udev_device_unref(udev_device* device) { return freed(device); }

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
