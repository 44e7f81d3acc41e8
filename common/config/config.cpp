// SPDX-License-Identifier: Apache-2.0
#include "common/config/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/safe_toml.h"

namespace cyclorama {
namespace {

constexpr std::size_t kFileLimitBytes = 1u << 20;

std::string without_unit(std::string_view key) {
  const std::size_t cut = key.rfind('_');
  return std::string(cut == std::string_view::npos ? key : key.substr(0, cut));
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row[b.size()];
}

}  // namespace

struct Config::Document {
  std::string name;
  toml::table table;
  std::multimap<unsigned, std::string> mistakes;  ///< Keyed by line.
  std::vector<std::shared_ptr<ConfigTable::Node>> nodes;
};

struct ConfigTable::Node {
  Config::Document* document = nullptr;
  const toml::table* table = nullptr;  ///< Null if the table is absent.
  unsigned line = 1;                   ///< Line of the table's header, for missing keys.
  std::string path;                    ///< Prefix of this table's keys, such as "wall.".
  std::set<std::string, std::less<>> asked;
  std::set<std::string, std::less<>> missing;  ///< Required keys that were requested and are absent.

  const toml::node* find(std::string_view key) {
    asked.insert(std::string(key));
    return table == nullptr ? nullptr : table->get(key);
  }
  void mistake(unsigned at_line, std::string_view key, std::string_view what) const {
    document->mistakes.emplace(at_line, fmt::format("{}:{}: {}{}: {}", document->name, at_line, path, key, what));
  }
  /// Returns the node; null if it is absent. Notes a required key as missing.
  const toml::node* find_or_note(std::string_view key, bool required) {
    const toml::node* const node = find(key);
    if (node == nullptr && required) missing.insert(std::string(key));
    return node;
  }
  std::optional<double> number_of(const toml::node& node, std::string_view key, Range range) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) {
      mistake(node.source().begin.line, key, "must be a number");
    } else if (!(*value >= range.min && *value <= range.max)) {
      mistake(node.source().begin.line, key,
              fmt::format("is {}; it must be between {} and {}", *value, range.min, range.max));
    } else {
      return value;
    }
    return std::nullopt;
  }
  /// Returns the known key that equals `key` apart from its unit, or is within two edits of it; empty if there is none.
  [[nodiscard]] std::string meant_by(std::string_view key) const {
    for (const std::string& known : asked) {
      if (without_unit(known) == without_unit(key)) return known;
    }
    for (const std::string& known : asked) {
      if (edit_distance(known, key) <= 2 && edit_distance(known, key) < key.size()) return known;
    }
    return "";
  }
  /// Reports a misspelt key only as misspelt, not also as missing.
  void note_unknown_and_missing_keys() {
    if (table != nullptr) {
      for (const auto& [key, value] : *table) {
        if (asked.contains(key.str())) continue;
        const std::string meant = meant_by(key.str());
        missing.erase(meant);
        std::string remedy = "is not a setting; remove it";
        if (!meant.empty()) {
          const bool same_name = without_unit(meant) == without_unit(key.str());
          remedy = same_name ? fmt::format("is not a setting; write '{}', in that unit", meant)
                             : fmt::format("is not a setting; did you mean '{}'?", meant);
        }
        mistake(key.source().begin.line, key.str(), remedy);
      }
    }
    for (const std::string& key : missing) mistake(line, key, "is missing; add it");
  }
};

ConfigTable::ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

bool ConfigTable::has(std::string_view key) const { return node_->find(key) != nullptr; }

double ConfigTable::number(std::string_view key, Range range, std::optional<double> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  const double harmless = fallback.value_or(range.min);
  return node == nullptr ? harmless : node_->number_of(*node, key, range).value_or(harmless);
}

int ConfigTable::integer(std::string_view key, Range range, std::optional<int> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  const int harmless = fallback.value_or(static_cast<int>(range.min));
  if (node == nullptr) return harmless;
  if (!node->is_integer()) {
    node_->mistake(node->source().begin.line, key, "must be a whole number");
    return harmless;
  }
  return static_cast<int>(node_->number_of(*node, key, range).value_or(harmless));
}

bool ConfigTable::flag(std::string_view key, std::optional<bool> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  if (node == nullptr) return fallback.value_or(false);
  if (!node->is_boolean()) node_->mistake(node->source().begin.line, key, "must be true or false");
  return node->value<bool>().value_or(fallback.value_or(false));
}

std::string ConfigTable::text(std::string_view key, std::optional<std::string> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  if (node == nullptr) return fallback.value_or("");
  if (!node->is_string()) node_->mistake(node->source().begin.line, key, "must be a text in quotes");
  return node->value<std::string>().value_or(fallback.value_or(""));
}

std::string ConfigTable::choice(std::string_view key, const std::vector<std::string>& legal,
                                std::optional<std::string> fallback) {
  std::string value = text(key, fallback ? fallback : std::nullopt);
  const toml::node* const node = node_->find(key);
  if (node == nullptr || !node->is_string()) return value.empty() ? legal.front() : value;
  if (std::find(legal.begin(), legal.end(), value) != legal.end()) return value;
  node_->mistake(node->source().begin.line, key,
                 fmt::format("is '{}'; it must be one of: {}", printable(value), fmt::join(legal, ", ")));
  return legal.front();
}

std::vector<double> ConfigTable::numbers(std::string_view key, std::size_t count, Range range,
                                         std::optional<std::vector<double>> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  std::vector<double> harmless = fallback.value_or(std::vector<double>(count, range.min));
  if (node == nullptr) return harmless;
  const toml::array* const array = node->as_array();
  if (array == nullptr || (count != 0 && array->size() != count)) {
    node_->mistake(node->source().begin.line, key,
                   count == 0 ? "must be a list of numbers" : fmt::format("must be a list of {} numbers", count));
    return harmless;
  }
  std::vector<double> values;
  for (const toml::node& item : *array) {
    const std::optional<double> value = node_->number_of(item, key, range);
    if (!value) return harmless;
    values.push_back(*value);
  }
  return values;
}

std::vector<std::vector<double>> ConfigTable::points(std::string_view key, std::size_t dimension, Range range) {
  const toml::node* const node = node_->find(key);
  if (node == nullptr) return {};
  const auto wrong = [&] {
    node_->mistake(node->source().begin.line, key, fmt::format("must be a list of lists of {} numbers", dimension));
    return std::vector<std::vector<double>>{};
  };
  const toml::array* const array = node->as_array();
  if (array == nullptr) return wrong();
  std::vector<std::vector<double>> points;
  for (const toml::node& item : *array) {
    const toml::array* const inner = item.as_array();
    if (inner == nullptr || inner->size() != dimension) return wrong();
    std::vector<double> point;
    for (const toml::node& coordinate : *inner) {
      const std::optional<double> value = node_->number_of(coordinate, key, range);
      if (!value) return {};
      point.push_back(*value);
    }
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<std::string> ConfigTable::texts(std::string_view key, std::optional<std::vector<std::string>> fallback) {
  const toml::node* const node = node_->find_or_note(key, !fallback);
  if (node == nullptr) return fallback.value_or(std::vector<std::string>{});
  std::vector<std::string> values;
  if (const toml::array* const array = node->as_array()) {
    for (const toml::node& item : *array) {
      if (const auto value = item.value_exact<std::string>()) values.push_back(*value);
    }
    if (values.size() == array->size()) return values;
  }
  node_->mistake(node->source().begin.line, key, "must be a list of texts in quotes");
  return fallback.value_or(std::vector<std::string>{});
}

ConfigTable ConfigTable::table(std::string_view key) {
  const toml::node* const node = node_->find(key);
  auto child = std::make_shared<Node>();
  child->document = node_->document;
  child->line = node == nullptr ? node_->line : node->source().begin.line;
  child->path = fmt::format("{}{}.", node_->path, key);
  if (node != nullptr) {
    child->table = node->as_table();
    if (child->table == nullptr) node_->mistake(child->line, key, fmt::format("must be a table: [{}]", key));
  }
  node_->document->nodes.push_back(child);
  return ConfigTable(child);
}

std::vector<ConfigTable> ConfigTable::tables(std::string_view key) {
  const toml::node* const node = node_->find(key);
  std::vector<ConfigTable> children;
  if (node == nullptr) return children;
  const toml::array* const array = node->as_array();
  if (array == nullptr || (!array->empty() && !array->is_homogeneous(toml::node_type::table))) {
    node_->mistake(node->source().begin.line, key, fmt::format("must be a list of tables: [[{}]]", key));
    return children;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    auto child = std::make_shared<Node>();
    child->document = node_->document;
    child->table = array->get_as<toml::table>(i);
    child->line = child->table->source().begin.line;
    child->path = fmt::format("{}{}[{}].", node_->path, key, i);
    node_->document->nodes.push_back(child);
    children.push_back(ConfigTable(child));
  }
  return children;
}

void ConfigTable::refuse(std::string_view key, std::string_view what_and_remedy) {
  const toml::node* const node = node_->find(key);
  node_->mistake(node == nullptr ? node_->line : node->source().begin.line, key, what_and_remedy);
}

void ConfigTable::refuse_renamed(std::string_view key, std::string_view new_key) {
  if (has(key)) refuse(key, fmt::format("is called '{}' now; rename it", new_key));
}

Config::Config(std::unique_ptr<Document> document) : document_(std::move(document)) {}
Config::Config(Config&&) noexcept = default;
Config& Config::operator=(Config&&) noexcept = default;
Config::~Config() = default;

Result<Config> Config::read(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::string text, read_text_file(path, kFileLimitBytes));
  return parse(text, path.string());
}

Result<Config> Config::parse(std::string_view text, std::string name) {
  toml::parse_result result = toml::parse(text);
  if (!result) {
    const toml::parse_error& error = result.error();
    return Error(ErrorCode::kBadData, fmt::format("{}:{}:{}: not TOML: {}", name, error.source().begin.line,
                                                  error.source().begin.column, error.description()));
  }
  auto document = std::make_unique<Document>();
  document->name = std::move(name);
  document->table = std::move(result).table();
  return Config(std::move(document));
}

ConfigTable Config::root() {
  auto node = std::make_shared<ConfigTable::Node>();
  node->document = document_.get();
  node->table = &document_->table;
  document_->nodes.push_back(node);
  return ConfigTable(node);
}

Status Config::finish() const {
  for (const auto& node : document_->nodes) node->note_unknown_and_missing_keys();
  document_->nodes.clear();
  const auto& mistakes = document_->mistakes;
  if (mistakes.empty()) return Done{};
  std::string message = mistakes.begin()->second;
  if (mistakes.size() > 1) message += fmt::format(" (and {} more)", mistakes.size() - 1);
  return Error(ErrorCode::kBadData, std::move(message));
}

}  // namespace cyclorama
