// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/gpu_fence.h"

#include <linux/sync_file.h>
#include <sys/ioctl.h>

namespace cyclorama::output {

std::optional<TimePoint> GpuFence::reached_at() const {
  sync_fence_info fence{};
  sync_file_info file{};
  file.num_fences = 1;  // A fence that EGL makes is a single one.
  file.sync_fence_info = reinterpret_cast<std::uintptr_t>(&fence);
  if (::ioctl(fd(), SYNC_IOC_FILE_INFO, &file) != 0 || fence.status != 1) return std::nullopt;
  return from_nanoseconds(static_cast<std::int64_t>(fence.timestamp_ns));
}

}  // namespace cyclorama::output
