// SPDX-License-Identifier: Apache-2.0
/// The elements, attributes and texts of the XML section of an E57 file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scene {

struct E57Node {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;  ///< All texts of the element, without those of its children.
  std::vector<E57Node> children;

  /// First child of that name; null if there is none.
  [[nodiscard]] const E57Node* child(std::string_view wanted) const;
  [[nodiscard]] std::string_view attribute(std::string_view wanted) const;    ///< Empty if there is none.
  [[nodiscard]] std::optional<double> number(std::string_view wanted) const;  ///< Value of an attribute.
  /// Returns the number in a child; 0 without one, because E57 omits zeros.
  [[nodiscard]] double number_of_child(std::string_view wanted) const;
};

/// Returns the root element. Errors: kBadData, with the byte offset, for text that is not well formed, for document
/// types and for elements nested more than 32 deep. Entities other than the five of XML stay as they are written.
Result<E57Node> parse_e57_xml(std::string_view xml);

}  // namespace cyclorama::scene
