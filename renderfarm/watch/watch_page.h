// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/http/page_file.h"

namespace cyclorama::watch {

/// Returns the files of renderfarm/watch/page/.
[[nodiscard]] std::span<const PageFile> watch_page_files();

}  // namespace cyclorama::watch
