// SPDX-License-Identifier: Apache-2.0
/// The XML section of an E57 file: elements, attributes and texts, and nothing else of XML.
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
  std::string text;  ///< All of its texts, without those of its children.
  std::vector<E57Node> children;

  [[nodiscard]] const E57Node* child(std::string_view wanted) const;          ///< The first of that name; may be null.
  [[nodiscard]] std::string_view attribute(std::string_view wanted) const;    ///< Empty if there is none.
  [[nodiscard]] std::optional<double> number(std::string_view wanted) const;  ///< An attribute's.
  /// The number that a child holds; E57 leaves zeros out.
  [[nodiscard]] double number_of_child(std::string_view wanted) const;
};

/// Returns the root element. Errors: kBadData, with the byte, for anything that is not well formed, document types,
/// entities other than XML's own five, and elements nested more than 32 deep.
Result<E57Node> parse_e57_xml(std::string_view xml);

}  // namespace cyclorama::scene
