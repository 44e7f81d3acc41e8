// SPDX-License-Identifier: Apache-2.0
/// The kernel's virtual video driver (Documentation/admin-guide/media/vivid.rst) as a cable: what is shown at its HDMI
/// output is what a camera driver reads at its HDMI input.
#pragma once

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "common/image/image.h"

namespace cyclorama {

/// Module parameters for one input and one output, both HDMI, and nothing else.
inline constexpr const char* kVividParameters =
    "n_devs=1 node_types=0x101 num_inputs=1 input_types=3 num_outputs=1 output_types=1";

/// Shows one picture of 640x480 in grey, at about 60 per second, on a thread of its own, until it dies. Thread-bound.
class VividCable {
 public:
  /// Joins output to input, without the driver's own writing over it. kNotFound  the driver is not loaded.
  static Result<std::unique_ptr<VividCable>> plug(const GreyImage& picture);
  ~VividCable();

  /// Sets a control of the driver's by its name, as "Disconnect". kNotFound  it has none of that name.
  static Status set_control(const std::string& name, int value);
  /// "/dev/videoN" of the input.
  static Result<std::string> input_path();

 private:
  VividCable() = default;
  Status show(const std::stop_token& stop);

  UniqueFd output_;
  std::vector<std::pair<void*, std::size_t>> maps_;
  std::jthread thread_;
};

}  // namespace cyclorama
