// SPDX-License-Identifier: Apache-2.0
/// Pictures one after the other in one answer: multipart/x-mixed-replace (RFC 2046, 5.1), as browsers and players take.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace cyclorama {

inline constexpr const char* kMjpegType = "multipart/x-mixed-replace; boundary=cyclorama-picture";

/// What the answer begins with.
[[nodiscard]] std::string mjpeg_begin();
/// One picture. The boundary after it is part of it, since browsers show a picture when they see its end.
[[nodiscard]] std::string mjpeg_part(std::span<const std::byte> jpeg);

}  // namespace cyclorama
