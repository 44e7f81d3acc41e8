// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/xml_reader.h"

#include <algorithm>
#include <cmath>

#include "appliance/interchange/fault.h"
#include "common/base/text.h"

namespace cyclorama::interchange {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

bool same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

std::string XmlElement::location() const {
  return fmt::format("{}, line {}, <{}>", document_->name(), document_->line_of(node_.offset_debug()),
                     printable(name()));
}

bool XmlElement::is(std::string_view name) const { return same_word(node_.name(), name); }

std::vector<XmlElement> XmlElement::all_children() const {
  std::vector<XmlElement> found;
  for (const pugi::xml_node node : node_.children()) {
    if (node.type() == pugi::node_element) found.push_back(XmlElement(node, document_));
  }
  return found;
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
  std::vector<XmlElement> found = all_children();
  std::erase_if(found, [&](const XmlElement& child) { return !child.is(name); });
  return found;
}

Result<std::optional<XmlElement>> XmlElement::optional_child(std::string_view name) const {
  const std::vector<XmlElement> found = children(name);
  if (found.size() > 1) return fault(found[1].location(), "it is there twice", "remove one");
  if (found.empty()) return std::optional<XmlElement>();
  return std::optional<XmlElement>(found[0]);
}

Result<XmlElement> XmlElement::child(std::string_view name) const {
  TRY_ASSIGN(const std::optional<XmlElement> found, optional_child(name));
  if (!found) return fault(location(), fmt::format("it has no <{}>", name), "add it, or export the file again");
  return *found;
}

Result<std::optional<std::string>> XmlElement::optional_attribute(std::string_view name) const {
  std::optional<std::string> found;
  for (const pugi::xml_attribute attribute : node_.attributes()) {
    if (!same_word(attribute.name(), name)) continue;
    if (found) return fault(location(), fmt::format("its {} is there twice", name), "remove one");
    found = std::string(trimmed(attribute.value()));
  }
  return found;
}

Result<std::string> XmlElement::attribute(std::string_view name) const {
  TRY_ASSIGN(std::optional<std::string> found, optional_attribute(name));
  if (!found) return fault(location(), fmt::format("it has no attribute {}", name), "add it, or export the file again");
  return *std::move(found);
}

Result<double> XmlElement::number_attribute(std::string_view name) const {
  TRY_ASSIGN(const std::string text, attribute(name));
  const auto value = parse_double(text);
  if (!value || !std::isfinite(*value)) {
    return fault(location(), fmt::format("its {} is '{}'", name, printable(text)), "give a number");
  }
  return *value;
}

Result<std::optional<int>> XmlElement::optional_count_attribute(std::string_view name, int max) const {
  TRY_ASSIGN(const std::optional<std::string> text, optional_attribute(name));
  if (!text) return std::optional<int>();
  const auto value = parse_integer(*text);
  if (!value || *value < 1 || *value > max) {
    return fault(location(), fmt::format("its {} is '{}'", name, printable(*text)),
                 fmt::format("give a whole number of 1 to {}", max));
  }
  return std::optional<int>(static_cast<int>(*value));
}

std::string XmlElement::text() const { return std::string(trimmed(node_.child_value())); }

Result<double> XmlElement::number_in(std::string_view child_name) const {
  TRY_ASSIGN(const XmlElement element, child(child_name));
  const std::string text = element.text();
  const auto value = parse_double(text);
  if (!value || !std::isfinite(*value)) {
    return fault(element.location(), fmt::format("it holds '{}'", printable(text)), "give a number");
  }
  return *value;
}

Result<std::unique_ptr<XmlDocument>> XmlDocument::parse(std::string_view text, std::string name,
                                                        std::size_t limit_bytes) {
  if (text.size() > limit_bytes) {
    return fault(name, fmt::format("{} bytes of XML, and at most {} are accepted", text.size(), limit_bytes),
                 "remove what does not belong to the warp");
  }
  std::unique_ptr<XmlDocument> document(new XmlDocument());
  document->name_ = std::move(name);
  document->line_starts_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') document->line_starts_.push_back(i + 1);
  }
  const pugi::xml_parse_result parsed = document->document_.load_buffer(text.data(), text.size());
  if (!parsed) {
    return fault(fmt::format("{}, line {}", document->name_, document->line_of(parsed.offset)),
                 fmt::format("this is no XML ({})", parsed.description()), "export the file again");
  }
  return document;
}

Result<XmlElement> XmlDocument::root(std::string_view name) const {
  const XmlElement element(document_.document_element(), this);
  if (!element.is(name)) {
    return fault(fmt::format("{}, line {}", name_, line_of(element.node_.offset_debug())),
                 fmt::format("it begins with <{}> and not with <{}>", printable(element.name()), name),
                 "give a file of the right kind");
  }
  return element;
}

std::size_t XmlDocument::line_of(std::ptrdiff_t offset) const {
  const std::size_t at = offset < 0 ? 0 : static_cast<std::size_t>(offset);
  return static_cast<std::size_t>(std::upper_bound(line_starts_.begin(), line_starts_.end(), at) -
                                  line_starts_.begin());
}

}  // namespace cyclorama::interchange
