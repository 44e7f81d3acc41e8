// SPDX-License-Identifier: Apache-2.0
/// The kernel's virtual video driver (Documentation/admin-guide/media/vivid.rst) as a cable: a camera driver reads from
/// its HDMI input the pictures that are sent to its HDMI output.
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

/// Sends one grey picture of 640x480 at about 60 per second, on a thread of its own, until it is destroyed.
/// Thread-bound.
class VividCable {
 public:
  /// Connects the output to the input, without the driver's own overlay. Errors: kNotFound if the driver is not loaded.
  static Result<std::unique_ptr<VividCable>> plug(const GreyImage& picture);
  ~VividCable();

  /// Sets a control of the driver by its name, such as "Disconnect". Errors: kNotFound if there is no such control.
  static Status set_control(const std::string& name, int value);
  /// Path of the input, "/dev/videoN".
  static Result<std::string> input_path();

 private:
  VividCable() = default;
  Status show(const std::stop_token& stop);

  UniqueFd output_;
  std::vector<std::pair<void*, std::size_t>> maps_;
  std::jthread thread_;
};

}  // namespace cyclorama
