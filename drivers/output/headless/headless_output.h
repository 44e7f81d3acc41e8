// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/output/output.h"

namespace cyclorama::output {

struct HeadlessOptions {
  enum class Renderer { kAny, kEgl, kOsMesa };  ///< kAny: EGL, or OSMesa if EGL is not available.

  std::vector<HeadMode> heads;
  double refresh_hz = 60.0;
  std::filesystem::path run_dir;  ///< Directory for each head's shared picture (shared_picture.h); empty for none.
  Renderer renderer = Renderer::kAny;
  /// Flag that another thread may write and that must outlive the output. While it is false, shared pictures are black.
  /// Null: always on.
  const std::atomic<bool>* is_awake = nullptr;
};

/// Opens heads in memory that are refreshed on the absolute schedule of `clock`. A picture counts as shown as soon as
/// present() has drawn it completely. Missed refreshes appear as a gap in the refresh number. Makes its context current
/// on the calling thread.
///
/// Errors: kInvalidArgument if there is no head, or a size or the refresh rate is out of range; kUnavailable if there
/// is no GL, with the reason; those of SharedPictureWriter::create() for the run directory. `clock` must outlive the
/// output.
Result<std::unique_ptr<Output>> open_headless_output(const HeadlessOptions& options, const Clock& clock);

}  // namespace cyclorama::output
