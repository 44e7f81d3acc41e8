# SPDX-License-Identifier: Apache-2.0

# project_page(SOURCE page HEADER kiosk/operator/page_files.h FUNCTION page_files FILES index.html page.css)
# The files of ./page go into the program: ${page} names the source, made in the build folder, that holds them.
# HEADER declares FUNCTION, which returns a span of PageFile.
function(project_page)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE;HEADER;FUNCTION" "FILES")
  set(made "${CMAKE_CURRENT_BINARY_DIR}/${arg_FUNCTION}.cpp")
  set(folder "${CMAKE_CURRENT_SOURCE_DIR}/page")
  list(TRANSFORM arg_FILES PREPEND "${folder}/" OUTPUT_VARIABLE paths)
  list(JOIN arg_FILES "," names)
  add_custom_command(OUTPUT "${made}" DEPENDS ${paths} "${PROJECT_SOURCE_DIR}/common/cmake/embed_page.cmake"
    COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${made}" -D "FOLDER=${folder}" -D "HEADER=${arg_HEADER}"
            -D "FUNCTION=${arg_FUNCTION}" -D "FILES=${names}" -P "${PROJECT_SOURCE_DIR}/common/cmake/embed_page.cmake"
    VERBATIM)
  set(${arg_SOURCE} "${made}" PARENT_SCOPE)
endfunction()
