// SPDX-License-Identifier: Apache-2.0
/// XML elements with their locations, so that readers' errors can name the line. Adapter of pugixml.
///
/// Names are case-insensitive, because exporters differ ("Xresolution", "xResolution"). A duplicate child is a fault
/// where only one is allowed.
#pragma once

#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::interchange {

/// An element of an XmlDocument, which it borrows.
class XmlElement {
 public:
  [[nodiscard]] std::string_view name() const { return node_.name(); }
  [[nodiscard]] bool is(std::string_view name) const;
  /// Returns "mpcdi.xml, line 12, <region>".
  [[nodiscard]] std::string location() const;

  /// Returns the children with a name, in order.
  [[nodiscard]] std::vector<XmlElement> children(std::string_view name) const;
  [[nodiscard]] std::vector<XmlElement> all_children() const;
  /// Returns the child with a name; empty if there is none, a fault if there are several.
  Result<std::optional<XmlElement>> optional_child(std::string_view name) const;
  Result<XmlElement> child(std::string_view name) const;

  Result<std::optional<std::string>> optional_attribute(std::string_view name) const;
  Result<std::string> attribute(std::string_view name) const;
  /// Returns an attribute as a number; a fault if it is not finite.
  Result<double> number_attribute(std::string_view name) const;
  /// Returns an attribute as a count of at most `max`; empty if there is none.
  Result<std::optional<int>> optional_count_attribute(std::string_view name, int max) const;

  /// Returns the text without surrounding blanks.
  [[nodiscard]] std::string text() const;
  /// Returns the text of a required child as a number; a fault if it is not finite.
  Result<double> number_in(std::string_view child_name) const;

 private:
  friend class XmlDocument;
  XmlElement(pugi::xml_node node, const class XmlDocument* document) : node_(node), document_(document) {}
  pugi::xml_node node_;
  const class XmlDocument* document_ = nullptr;
};

/// A parsed document. Immovable, since elements point to it. Thread-bound.
class XmlDocument {
 public:
  /// Parses a document. `name` is the file's name in locations. Errors: kBadData if the XML is not well-formed (with
  /// the line), or exceeds `limit_bytes`.
  static Result<std::unique_ptr<XmlDocument>> parse(std::string_view text, std::string name, std::size_t limit_bytes);
  XmlDocument(const XmlDocument&) = delete;
  XmlDocument& operator=(const XmlDocument&) = delete;

  /// Returns the outermost element; a fault if it has another name.
  Result<XmlElement> root(std::string_view name) const;
  [[nodiscard]] std::size_t line_of(std::ptrdiff_t offset) const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  XmlDocument() = default;
  std::string name_;
  std::vector<std::size_t> line_starts_;
  pugi::xml_document document_;
};

}  // namespace cyclorama::interchange
