// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/output/output.h"

namespace cyclorama::output {

struct HeadlessOptions {
  enum class Renderer { kAny, kEgl, kOsMesa };  ///< kAny: EGL, and OSMesa where EGL cannot.

  std::vector<HeadMode> heads;
  double refresh_hz = 60.0;
  std::filesystem::path run_dir;  ///< Where each head's shared picture goes (shared_picture.h); empty: nowhere.
  Renderer renderer = Renderer::kAny;
  /// While false, shared pictures are black. Null: always on. Outlives the output; another thread may write it.
  const std::atomic<bool>* is_awake = nullptr;
};

/// Heads in memory, refreshed at an absolute pace of `clock`. A picture counts as shown as soon as present() has it
/// whole. Where a refresh is missed, the next one's number tells. Makes its context current on the calling thread.
///
/// kInvalidArgument  no head, a head's size or the refresh rate out of range.   kUnavailable  no GL, and why.
/// Errors of SharedPictureWriter::create() for the run directory. `clock` must outlive the output.
Result<std::unique_ptr<Output>> open_headless_output(const HeadlessOptions& options, const Clock& clock);

}  // namespace cyclorama::output
