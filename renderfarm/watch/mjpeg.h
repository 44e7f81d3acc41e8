// SPDX-License-Identifier: Apache-2.0
/// A sequence of pictures in one response: multipart/x-mixed-replace (RFC 2046, 5.1), in the form that browsers and
/// players accept.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace cyclorama::watch {

inline constexpr const char* kMjpegType = "multipart/x-mixed-replace; boundary=cyclorama-picture";

/// Returns the beginning of the response.
[[nodiscard]] std::string mjpeg_begin();
/// Returns one picture and the boundary after it, because browsers show a picture only when they have seen its end.
[[nodiscard]] std::string mjpeg_part(std::span<const std::byte> jpeg);

}  // namespace cyclorama::watch
