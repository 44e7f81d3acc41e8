// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/http/page_file.h"

namespace cyclorama::operations {

/// Returns the files of kiosk/operator/page/.
[[nodiscard]] std::span<const PageFile> page_files();

/// Returns the files that need no PIN: "/login.html" and the files that it uses.
[[nodiscard]] std::span<const PageFile> login_files();

}  // namespace cyclorama::operations
