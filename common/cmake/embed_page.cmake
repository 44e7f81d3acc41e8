# SPDX-License-Identifier: Apache-2.0
# cmake -D OUTPUT=page_files.cpp -D HEADER=kiosk/operator/page_files.h -D FUNCTION=operations::page_files
#       -D FILES=page/index.html,page/page.css -P embed_page.cmake: writes a page's files as one C++ source.
set(types_html "text/html; charset=utf-8")
set(types_css "text/css; charset=utf-8")
set(types_js "text/javascript; charset=utf-8")
set(types_svg "image/svg+xml")
set(arrays "")
set(entries "")
set(count 0)
string(REPLACE "," ";" files "${FILES}")
foreach(file IN LISTS files)
  cmake_path(GET file FILENAME name)
  file(READ "${file}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND arrays "const char kFile${count}[] = {${bytes}};\n")
  cmake_path(GET name EXTENSION LAST_ONLY extension)
  string(SUBSTRING "${extension}" 1 -1 extension)
  set(path "/${name}")
  if(name STREQUAL "index.html")
    set(path "/")
  endif()
  string(APPEND entries "    {\"${path}\", \"${types_${extension}}\", {kFile${count}, sizeof kFile${count}}},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(WRITE "${OUTPUT}" "#include \"${HEADER}\"

namespace {
${arrays}const cyclorama::PageFile kFiles[] = {
${entries}};
}  // namespace
std::span<const cyclorama::PageFile> cyclorama::${FUNCTION}() { return kFiles; }
")
