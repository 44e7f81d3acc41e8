# SPDX-License-Identifier: Apache-2.0

# project_page(SOURCE page HEADER kiosk/operator/page_files.h FUNCTION operations::page_files FILES index.html page.css
#              SHARED texts.js)
# Embeds files of ./page, and of common/http/page helpers.js and those that SHARED names, in the program: ${page} is the
# generated source that holds them.
# HEADER declares FUNCTION, which returns a span of PageFile.
function(project_page)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE;HEADER;FUNCTION" "FILES;SHARED")
  string(REPLACE "::" "_" name "${arg_FUNCTION}")
  set(made "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  list(TRANSFORM arg_FILES PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/page/" OUTPUT_VARIABLE paths)
  list(TRANSFORM arg_SHARED PREPEND "${PROJECT_SOURCE_DIR}/common/http/page/")
  list(APPEND paths "${PROJECT_SOURCE_DIR}/common/http/page/helpers.js" ${arg_SHARED})
  list(JOIN paths "," files)
  add_custom_command(OUTPUT "${made}" DEPENDS ${paths} "${PROJECT_SOURCE_DIR}/common/cmake/embed_page.cmake"
    COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${made}" -D "HEADER=${arg_HEADER}" -D "FUNCTION=${arg_FUNCTION}"
            -D "FILES=${files}" -P "${PROJECT_SOURCE_DIR}/common/cmake/embed_page.cmake"
    VERBATIM)
  # Two such sources define the same names.
  set_source_files_properties("${made}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set(${arg_SOURCE} "${made}" PARENT_SCOPE)
endfunction()
