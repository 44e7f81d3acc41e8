// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/e57_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/text.h"
#include "common/base/text_lines.h"

namespace cyclorama::scene {
namespace {

constexpr int kMaxDepth = 32;
constexpr std::string_view kSpace = " \t\r\n";

class Parser {
 public:
  explicit Parser(std::string_view xml) : xml_(xml) {}

  Result<E57Node> root() {
    if (xml_.starts_with("\xef\xbb\xbf")) at_ = 3;
    TRY(skip_between());
    if (!take("<")) return bad("begins with no element");
    return element(0);
  }

 private:
  [[nodiscard]] Error bad(std::string_view what) const {
    return Error(ErrorCode::kBadData, fmt::format("its XML {} at byte {}", what, at_));
  }
  [[nodiscard]] std::string_view rest() const { return xml_.substr(at_); }
  bool take(std::string_view word) {
    if (!rest().starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  void skip_space() { at_ = std::min(xml_.find_first_not_of(kSpace, at_), xml_.size()); }
  /// Returns the text before `end`, and moves past `end`.
  Result<std::string_view> until(std::string_view end) {
    const std::size_t found = xml_.find(end, at_);
    if (found == std::string_view::npos) return bad(fmt::format("lacks '{}'", end));
    const std::string_view before = xml_.substr(at_, found - at_);
    at_ = found + end.size();
    return before;
  }
  /// Skips space, comments and processing instructions.
  Status skip_between() {
    for (;;) {
      skip_space();
      if (take("<!--")) {
        TRY(until("-->"));
      } else if (take("<?")) {
        TRY(until("?>"));
      } else {
        return Done{};
      }
    }
  }

  Result<std::string> name() {
    const std::size_t end = std::min(xml_.find_first_of(" \t\r\n/>=<\"'", at_), xml_.size());
    if (end == at_) return bad("lacks a name");
    std::string found(xml_.substr(at_, end - at_));
    at_ = end;
    return found;
  }

  Result<std::string> without_entities(std::string_view text) const {
    constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
        {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}}};
    std::string plain;
    while (!text.empty()) {
      const auto* const entity = std::find_if(kEntities.begin(), kEntities.end(),
                                              [&](const auto& known) { return text.starts_with(known.first); });
      if (entity == kEntities.end() && text.front() == '&') return bad("has an unknown entity before");
      plain += entity != kEntities.end() ? entity->second : text.front();
      text.remove_prefix(entity != kEntities.end() ? entity->first.size() : 1);
    }
    return plain;
  }

  Status read_attributes(E57Node* node) {
    for (;;) {
      skip_space();
      if (rest().empty()) return bad("ends inside of a tag");
      if (rest().front() == '>' || rest().front() == '/') return Done{};
      TRY_ASSIGN(std::string key, name());
      skip_space();
      if (!take("=")) return bad("has an attribute without a value");
      skip_space();
      const bool is_double = take("\"");
      if (!is_double && !take("'")) return bad("has an attribute without quotes");
      TRY_ASSIGN(const std::string_view raw, until(is_double ? "\"" : "'"));
      TRY_ASSIGN(std::string value, without_entities(raw));
      node->attributes.emplace_back(std::move(key), std::move(value));
    }
  }

  /// Reads an element whose '<' has been taken.
  Result<E57Node> element(int depth) {
    if (depth > kMaxDepth) return bad("is nested too deeply");
    E57Node node;
    TRY_ASSIGN(node.name, name());
    TRY(read_attributes(&node));
    if (take("/>")) return node;
    if (!take(">")) return bad("has a tag without an end");
    for (;;) {
      const std::size_t tag = xml_.find('<', at_);
      if (tag == std::string_view::npos) return bad(fmt::format("lacks the end of '{}'", printable(node.name)));
      TRY_ASSIGN(const std::string text, without_entities(xml_.substr(at_, tag - at_)));
      node.text += text;
      at_ = tag;
      if (take("</")) {
        TRY_ASSIGN(const std::string_view closed, until(">"));
        if (trimmed(closed) != node.name)
          return bad(fmt::format("closes another element than '{}'", printable(node.name)));
        return node;
      }
      if (take("<![CDATA[")) {
        TRY_ASSIGN(const std::string_view raw, until("]]>"));
        node.text += raw;
      } else if (take("<!--")) {
        TRY(until("-->"));
      } else if (take("<?")) {
        TRY(until("?>"));
      } else {
        at_ += 1;
        TRY_ASSIGN(E57Node child, element(depth + 1));
        node.children.push_back(std::move(child));
      }
    }
  }

  std::string_view xml_;
  std::size_t at_ = 0;
};

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

Result<E57Node> parse_e57_xml(std::string_view xml) { return Parser(xml).root(); }

}  // namespace cyclorama::scene
