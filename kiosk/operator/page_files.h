// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace cyclorama {

/// A file of kiosk/operator/page/, inside the program: embed_page.cmake puts it there at build time.
struct PageFile {
  std::string_view path;  ///< As asked for: "/", "/page.css".
  std::string_view type;  ///< For Content-Type.
  std::string_view content;
};

[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace cyclorama
