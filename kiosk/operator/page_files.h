// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/http/page_file.h"

namespace cyclorama {

/// The files of kiosk/operator/page/.
[[nodiscard]] std::span<const PageFile> page_files();

/// Those which may be seen before the PIN was entered: "/login.html" and what it needs.
[[nodiscard]] std::span<const PageFile> login_files();

}  // namespace cyclorama
