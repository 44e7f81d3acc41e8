// SPDX-License-Identifier: Apache-2.0
// System calls. The FakeVideo answers those for its files; the system answers all others.
#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdarg>

#include "tests/doubles/fake_video/fake_video.h"

using cyclorama::FakeVideo;

namespace {

/// Returns the device of a file; null if the file is not the FakeVideo's.
FakeVideo::DeviceState* ours(int fd) {
  FakeVideo* const video = FakeVideo::the_or_null();
  return video == nullptr ? nullptr : video->device_of(fd);
}

bool fails(const char* call) {
  const int error = FakeVideo::the_or_null()->meet(call);
  if (error != 0) errno = error;
  return error != 0;
}

}  // namespace

extern "C" {

int __real_open(const char* path, int flags, ...);
int __real_close(int fd);
int __real_ioctl(int fd, unsigned long code, ...);
int __real_fstat(int fd, struct stat* status);
void* __real_mmap(void* hint, size_t length, int protection, int flags, int fd, off_t offset);
int __real_munmap(void* map, size_t length);
int __real_ppoll(struct pollfd* asked, nfds_t count, const struct timespec* timeout, const sigset_t* mask);

int __wrap_open(const char* path, int flags, ...) {
  FakeVideo* const video = FakeVideo::the_or_null();
  if (video == nullptr || std::string_view(path).substr(0, 10) != "/dev/video") {
    va_list arguments;
    va_start(arguments, flags);
    const auto mode = (flags & O_CREAT) != 0 ? va_arg(arguments, unsigned) : 0U;
    va_end(arguments);
    return __real_open(path, flags, mode);
  }
  FakeVideo::DeviceState* const device = video->device_at(path);
  if (device == nullptr || !device->is_plugged) {
    errno = ENOENT;
    return -1;
  }
  if (fails("open")) return -1;
  const int fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  video->opened(fd, device);
  return fd;
}

int __wrap_close(int fd) {
  if (FakeVideo* const video = FakeVideo::the_or_null()) video->closed(fd);
  return __real_close(fd);
}

int __wrap_fstat(int fd, struct stat* status) {
  FakeVideo::DeviceState* const device = ours(fd);
  const int result = __real_fstat(fd, status);
  if (device != nullptr) status->st_rdev = 0x5100 + device->number;
  return result;
}

int __wrap_ioctl(int fd, unsigned long code, ...) {
  va_list arguments;
  va_start(arguments, code);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  FakeVideo::DeviceState* const device = ours(fd);
  if (device == nullptr) return __real_ioctl(fd, code, argument);
  FakeVideo::the_or_null()->run(device);
  const int error = FakeVideo::the_or_null()->request(device, fd, code, argument);
  if (error == 0) return 0;
  errno = error;
  return -1;
}

void* __wrap_mmap(void* hint, size_t length, int protection, int flags, int fd, off_t offset) {
  FakeVideo* const video = FakeVideo::the_or_null();
  FakeVideo::DeviceState* const device = ours(fd);
  if (device == nullptr && (video == nullptr || video->exported.count(fd) == 0)) {
    return __real_mmap(hint, length, protection, flags, fd, offset);
  }
  if (fails("mmap")) return MAP_FAILED;
  if (device != nullptr) {
    fd = device->buffers.at(static_cast<std::size_t>(offset >> 26)).memory.get();
    offset = 0;
  }
  void* const map = __real_mmap(hint, length, protection, flags, fd, offset);
  if (map != MAP_FAILED) video->maps.insert(map);
  return map;
}

int __wrap_munmap(void* map, size_t length) {
  if (FakeVideo* const video = FakeVideo::the_or_null()) video->maps.erase(map);
  return __real_munmap(map, length);
}

int __wrap_ppoll(struct pollfd* asked, nfds_t count, const struct timespec* timeout, const sigset_t* mask) {
  FakeVideo::DeviceState* const device = count == 1 ? ours(asked->fd) : nullptr;
  if (device == nullptr) return __real_ppoll(asked, count, timeout, mask);
  if (fails("ppoll")) return -1;
  FakeVideo& video = *FakeVideo::the_or_null();
  asked->revents = 0;
  const cyclorama::TimePoint until =
      video.clock().now() + std::chrono::seconds(timeout->tv_sec) + std::chrono::nanoseconds(timeout->tv_nsec);
  for (;;) {
    video.run(device);
    if (!device->is_plugged) asked->revents = POLLERR | POLLHUP | POLLPRI;
    if (device->is_plugged && device->has_event) asked->revents = POLLPRI;
    if (!device->filled.empty()) asked->revents |= POLLIN;
    if (asked->revents != 0) return 1;
    const bool will_fill = device->is_streaming && !device->is_stalled && !device->queued.empty();
    if (!will_fill || device->next_at > until) break;
    video.clock().set(device->next_at);
  }
  video.clock().wait_until(until);
  return 0;
}

}  // extern "C"
