// SPDX-License-Identifier: Apache-2.0
#include "common/json/strict_json.h"

#include <fmt/format.h>

#include "common/base/text.h"

namespace cyclorama {

Result<nlohmann::json> parse_document(std::string_view text, const std::string& name, std::string_view remedy) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return Error(ErrorCode::kBadData, fmt::format("{}: byte {}: no JSON; {}", name, error.byte, remedy));
  } catch (const nlohmann::json::exception& error) {
    return Error(ErrorCode::kBadData, fmt::format("{}: {}; {}", name, printable(error.what(), 200), remedy));
  }
}

}  // namespace cyclorama
