// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace cyclorama {

/// A file of a page, inside the program: project_page() (common/cmake/page.cmake) puts it there at build time.
struct PageFile {
  std::string_view path;  ///< As asked for: "/", "/page.css".
  std::string_view type;  ///< For Content-Type.
  std::string_view content;
};

}  // namespace cyclorama
