// SPDX-License-Identifier: Apache-2.0
/// A sequence of pictures in one response: multipart/x-mixed-replace (RFC 2046, 5.1), as browsers and players accept
/// it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace cyclorama::watch {

inline constexpr const char* kMjpegType = "multipart/x-mixed-replace; boundary=cyclorama-picture";

/// Returns the beginning of the response.
[[nodiscard]] std::string mjpeg_begin();
/// Returns one picture, including the boundary after it, since browsers show a picture once they see its end.
[[nodiscard]] std::string mjpeg_part(std::span<const std::byte> jpeg);

}  // namespace cyclorama::watch
