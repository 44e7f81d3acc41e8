// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace cyclorama {

/// A file of a page, embedded in the program at build time by project_page() (common/cmake/page.cmake).
struct PageFile {
  std::string_view path;  ///< Path in requests: "/", "/page.css".
  std::string_view type;  ///< Value of Content-Type.
  std::string_view content;
};

}  // namespace cyclorama
