// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/e57_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

#include "common/base/text.h"
#include "common/base/text_lines.h"

namespace cyclorama::scene {
namespace {

constexpr int kMaxDepth = 32;

Error bad(std::string_view what, std::ptrdiff_t offset) {
  return Error(ErrorCode::kBadData, fmt::format("its XML at byte {}: {}", offset, what));
}

Result<E57Node> element(const pugi::xml_node& from, int depth) {
  if (depth > kMaxDepth) return bad("elements are nested too deeply", from.offset_debug());
  E57Node node;
  node.name = from.name();
  for (const pugi::xml_attribute& attribute : from.attributes()) {
    node.attributes.emplace_back(attribute.name(), attribute.value());
  }
  for (const pugi::xml_node& part : from.children()) {
    if (part.type() == pugi::node_element) {
      TRY_ASSIGN(E57Node child, element(part, depth + 1));
      node.children.push_back(std::move(child));
    } else {
      node.text += part.value();
    }
  }
  return node;
}

}  // namespace

const E57Node* E57Node::child(std::string_view wanted) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const E57Node& node) { return node.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

std::string_view E57Node::attribute(std::string_view wanted) const {
  for (const auto& [key, value] : attributes) {
    if (key == wanted) return value;
  }
  return {};
}

std::optional<double> E57Node::number(std::string_view wanted) const { return parse_double(attribute(wanted)); }

double E57Node::number_of_child(std::string_view wanted) const {
  const E57Node* const found = child(wanted);
  return found == nullptr ? 0.0 : parse_double(trimmed(found->text)).value_or(0.0);
}

Result<E57Node> parse_e57_xml(std::string_view xml) {
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) return bad(result.description(), result.offset);
  for (const pugi::xml_node& node : document.children()) {
    if (node.type() == pugi::node_doctype) return bad("document types are not supported", node.offset_debug());
  }
  return element(document.document_element(), 0);
}

}  // namespace cyclorama::scene
