# SPDX-License-Identifier: Apache-2.0
# Functions that every folder uses, so that each CMakeLists.txt is a list of names.

set(CYCLORAMA_SANITIZE "" CACHE STRING "address;undefined or thread")
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()

option(CYCLORAMA_FAST_BUILD "Precompiled headers, and several sources of a library at a time" ON)

# ccache makes a second build fast, even from a checkout in another folder.
find_program(CYCLORAMA_CCACHE ccache)
if(CYCLORAMA_CCACHE)
  set(_ccache_settings CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1)
  if(CYCLORAMA_FAST_BUILD)  # ccache needs these for precompiled headers; no source of ours uses __TIME__.
    list(APPEND _ccache_settings CCACHE_SLOPPINESS=pch_defines,time_macros)
  endif()
  set(CMAKE_CXX_COMPILER_LAUNCHER env ${_ccache_settings} ${CYCLORAMA_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# cyclorama_options: language level, warnings, sanitizers. PRIVATE to our own targets.
add_library(cyclorama_options INTERFACE)
target_compile_features(cyclorama_options INTERFACE cxx_std_20)
target_include_directories(cyclorama_options INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_definitions(cyclorama_options INTERFACE CYCLORAMA_VERSION="${PROJECT_VERSION}")
if(CYCLORAMA_FAST_BUILD)
  # Precompiled headers are shared between targets with the same macros. Abseil's package defines this one, and so every
  # target that links gRPC.
  target_compile_definitions(cyclorama_options INTERFACE NOMINMAX)
  # gcc takes a source that another source includes for a header, and warns about its anonymous namespaces.
  target_compile_options(cyclorama_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
target_compile_options(cyclorama_options INTERFACE
  -pthread  # For every source: it defines a macro, and precompiled headers require the same macros.
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wformat=2 -Wundef
  # gcc only; -Wnull-dereference is left out: under -O2 gcc 12 sees it in std::variant and in gtest.
  $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond;-Wlogical-op;-Wuseless-cast>)
# gcc starts to collect garbage at 128 MiB, which the precompiled headers exceed. Starting later saves about 8 % of the
# time.
target_compile_options(cyclorama_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>)
if(CYCLORAMA_WERROR)
  target_compile_options(cyclorama_options INTERFACE -Werror)
endif()
if(CYCLORAMA_SANITIZE)
  list(JOIN CYCLORAMA_SANITIZE "," _san)
  target_compile_options(cyclorama_options INTERFACE -fsanitize=${_san} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # gcc 12 warns about Eigen and std internals once the sanitizers have rewritten them.
    -Wno-error=maybe-uninitialized)
  if("undefined" IN_LIST CYCLORAMA_SANITIZE)
    # A null pointer traps without a check before every member, which costs a third of the build.
    target_compile_options(cyclorama_options INTERFACE -fno-sanitize=null,vptr,object-size)
  endif()
  target_link_options(cyclorama_options INTERFACE -fsanitize=${_san})
endif()
if(CYCLORAMA_FUZZ)
  target_compile_options(cyclorama_options INTERFACE -fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer)
  target_link_options(cyclorama_options INTERFACE -fsanitize=address,undefined)
endif()

# Headers that most sources include, precompiled once and shared by targets: GCC requires the same flags, which
# cyclorama_options gives. A target or source with other flags does not use them (DISABLE_PRECOMPILE_HEADERS,
# SKIP_PRECOMPILE_HEADERS); otherwise GCC reports the difference. Sources still include what they use, because clang
# compiles them without precompiled headers. The kinds are library, test, and the same with gRPC, library_wire and
# test_wire; program is library_wire with CLI11.
find_package(fmt 9 REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
set(_headers_library
  <algorithm> <array> <atomic> <bit> <chrono> <cmath> <condition_variable> <cstdint> <cstring> <deque> <filesystem>
  <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <random> <set> <span> <sstream>
  <stop_token> <string> <string_view> <thread> <tuple> <unordered_map> <utility> <variant> <vector>
  <fmt/format.h> <Eigen/Core> <Eigen/Geometry>)
set(_headers_wire <google/protobuf/message.h> <grpcpp/grpcpp.h>)
set(_headers_library_wire ${_headers_library} ${_headers_wire})
set(_headers_program ${_headers_library_wire} <CLI/CLI.hpp>)
set(_headers_test ${_headers_library} <gmock/gmock.h> <gtest/gtest.h>)
set(_headers_test_wire ${_headers_test} ${_headers_wire})
file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/precompiled.cpp" CONTENT "// Nothing beside the precompiled headers.\n")

# Gives a target the precompiled headers of a kind, with gRPC if it links the messages.
function(cyclorama_precompiled_headers target kind links)
  if(NOT CYCLORAMA_FAST_BUILD OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  if(links MATCHES "cyclorama::(wire|proto)(;|$)" AND NOT kind STREQUAL "program")
    string(APPEND kind _wire)
  endif()
  set(source cyclorama_headers_${kind})
  if(NOT TARGET ${source})
    add_library(${source} OBJECT EXCLUDE_FROM_ALL "${PROJECT_BINARY_DIR}/precompiled.cpp")
    target_link_libraries(${source} PRIVATE cyclorama_options fmt::fmt Eigen3::Eigen Threads::Threads)
    if(kind MATCHES "^test")
      target_link_libraries(${source} PRIVATE GTest::gtest)  # Its macros, too.
    endif()
    target_precompile_headers(${source} PRIVATE ${_headers_${kind}})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${source})
endfunction()

# Top folders that a top folder may link. tests/lint/check_layers.py has the rows of second-level folders.
set(CYCLORAMA_MAY_USE_common      common)
set(CYCLORAMA_MAY_USE_drivers     common drivers)
set(CYCLORAMA_MAY_USE_renderfarm  common renderfarm)
set(CYCLORAMA_MAY_USE_appliance   common drivers appliance)
set(CYCLORAMA_MAY_USE_kiosk       common kiosk renderfarm/client)
set(CYCLORAMA_MAY_USE_tests       common drivers renderfarm appliance kiosk tests)

function(_cyclorama_check_layer name deps)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE here)
  string(REGEX REPLACE "/.*" "" top "${here}")
  foreach(dep IN LISTS deps)
    if(NOT dep MATCHES "^cyclorama::")
      continue()
    endif()
    get_target_property(aliased ${dep} ALIASED_TARGET)
    get_target_property(dir ${aliased} CYCLORAMA_FOLDER)
    set(ok FALSE)
    foreach(allowed IN LISTS CYCLORAMA_MAY_USE_${top})
      if("${dir}/" MATCHES "^${allowed}/")
        set(ok TRUE)
      endif()
    endforeach()
    if(NOT ok)
      message(FATAL_ERROR "${name} (in ${here}/) may not depend on ${dep} (in ${dir}/). See docs/architecture.md#layers.")
    endif()
  endforeach()
endfunction()

# project_library(NAME warp SOURCES ... PUBLIC cyclorama::geometry PRIVATE ...)
# Sources are compiled several at a time, which parses their headers once. ALONE names sources that define a name in an
# anonymous namespace that another source of the library also defines; COMPILE_OPTIONS set a source apart by itself.
# HEADERS names the kind of its precompiled headers, if that is not `library`. HOT names sources whose loops need -O3.
# They do without precompiled headers: gcc takes the optimisation level from those, without a word.
function(project_library)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;HEADERS" "ALONE;HOT;SOURCES;PUBLIC;PRIVATE")
  if(NOT arg_HEADERS)
    set(arg_HEADERS library)
  endif()
  set(target cyclorama_${arg_NAME})
  set(hot)
  set(others ${arg_SOURCES})
  if(arg_HOT)
    set(hot ${target}_hot)
    list(REMOVE_ITEM others ${arg_HOT})
    add_library(${hot} OBJECT ${arg_HOT})
    target_compile_options(${hot} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O3>)
    target_link_libraries(${hot} PRIVATE cyclorama_options ${arg_PUBLIC} ${arg_PRIVATE})
    list(APPEND others $<TARGET_OBJECTS:${hot}>)
  endif()
  add_library(${target} STATIC ${others})
  add_library(cyclorama::${arg_NAME} ALIAS ${target})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE here)
  set_target_properties(${target} ${hot} PROPERTIES CYCLORAMA_FOLDER "${here}" LINKER_LANGUAGE CXX
    UNITY_BUILD ${CYCLORAMA_FAST_BUILD} UNITY_BUILD_BATCH_SIZE 6)
  if(NOT CYCLORAMA_FAST_BUILD)  # Precompiled headers are shared with programs, which are not position independent.
    set_target_properties(${target} ${hot} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  foreach(source IN LISTS arg_ALONE arg_HOT)
    if(NOT source IN_LIST arg_SOURCES)
      message(FATAL_ERROR "${arg_NAME}: ${source} is to be compiled in a special way, but is not among the sources.")
    endif()
  endforeach()
  set_source_files_properties(${arg_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  cyclorama_precompiled_headers(${target} ${arg_HEADERS} "${arg_PUBLIC};${arg_PRIVATE}")
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE cyclorama_options ${arg_PRIVATE})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  _cyclorama_check_layer(${arg_NAME} "${arg_PUBLIC};${arg_PRIVATE}")
endfunction()

# project_program(NAME cyclorama-tour COMPONENT museum MAIN tour_main.cpp LINK cyclorama::tour)
# Installs the program and, where help2man is present, a man page made from its --help.
function(project_program)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;COMPONENT;MAIN;ABOUT" "LINK")
  add_executable(${arg_NAME} ${arg_MAIN})
  set_target_properties(${arg_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
  target_link_libraries(${arg_NAME} PRIVATE cyclorama_options ${arg_LINK})
  cyclorama_precompiled_headers(${arg_NAME} program "${arg_LINK}")
  _cyclorama_check_layer(${arg_NAME} "${arg_LINK}")
  install(TARGETS ${arg_NAME} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${arg_COMPONENT})
  set_property(GLOBAL APPEND PROPERTY CYCLORAMA_PROGRAMS ${arg_NAME})
  set_property(GLOBAL PROPERTY CYCLORAMA_COMPONENT_${arg_NAME} ${arg_COMPONENT})
endfunction()

# project_bench(NAME cyclorama-bench-render MAIN bench_render_main.cpp LINK ...): a program that only measures, in tests/bench.
# It is built on demand, into tests/ of the build folder, and not installed.
function(project_bench)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME;MAIN" "LINK")
  add_executable(${arg_NAME} EXCLUDE_FROM_ALL ${arg_MAIN})
  set_target_properties(${arg_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_link_libraries(${arg_NAME} PRIVATE cyclorama_options ${arg_LINK})
  cyclorama_precompiled_headers(${arg_NAME} program "${arg_LINK}")
endfunction()

# project_test_group(LABEL TARGET...): `tests-LABEL` builds only what the tests with that label need.
function(project_test_group label)
  if(NOT TARGET tests-${label})
    add_custom_target(tests-${label})
  endif()
  add_dependencies(tests-${label} ${ARGN})
endfunction()

# project_test(unit/common/base/result_test LINK cyclorama::base [LABELS unit])
# PLAIN uses no precompiled headers: gcc 12 forgets that they are system headers, and warns about its own std::string.
function(project_test path)
  cmake_parse_arguments(PARSE_ARGV 1 arg "PLAIN" "TIMEOUT" "LINK;LABELS")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(CYCLORAMA_SANITIZE)
    math(EXPR arg_TIMEOUT "5 * ${arg_TIMEOUT}")
  endif()
  string(REPLACE "/" "." name "${path}")
  add_executable(${name} "${PROJECT_SOURCE_DIR}/tests/${path}.cpp")
  target_link_libraries(${name} PRIVATE cyclorama_options ${arg_LINK} GTest::gmock GTest::gtest_main)
  if(NOT arg_PLAIN)
    cyclorama_precompiled_headers(${name} test "${arg_LINK}")
  endif()
  add_test(NAME ${path} COMMAND ${name})
  set_tests_properties(${path} PROPERTIES LABELS "${arg_LABELS}" SKIP_RETURN_CODE 77 TIMEOUT ${arg_TIMEOUT}
    ENVIRONMENT "CYCLORAMA_SHARED=${PROJECT_SOURCE_DIR}/../shared;CYCLORAMA_SOURCE=${PROJECT_SOURCE_DIR};LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp;TSAN_OPTIONS=ignore_noninstrumented_modules=1 suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp")
  foreach(label IN LISTS arg_LABELS)
    project_test_group(${label} ${name})
  endforeach()
endfunction()

# project_fuzz(fuzz/ply_fuzz LINK cyclorama::scene): a libFuzzer target; tests/fuzz/run starts them.
function(project_fuzz path)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LINK")
  string(REPLACE "/" "." name "${path}")
  add_executable(${name} "${PROJECT_SOURCE_DIR}/tests/${path}.cpp")
  target_link_libraries(${name} PRIVATE cyclorama_options ${arg_LINK})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
endfunction()
