// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// Parses a text as the product parses the file. Errors use `name` as the file's name.
using Parser = std::function<Status(const std::string& text, const std::string& name)>;

/// Wraps a function that takes a text and a name and returns a Result.
template <typename Parse>
Parser parser(Parse parse) {
  return [parse](const std::string& text, const std::string& name) -> Status {
    const auto read = parse(text, name);
    if (!read) return read.error();
    return Done{};
  };
}

/// Returns the farm's parsers by the file's name.
[[nodiscard]] std::map<std::string, Parser> farm_parsers();

}  // namespace cyclorama
