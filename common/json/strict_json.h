// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// JSON read as settings are (common/config): reading goes on after a mistake with a harmless value, so that code reads
/// like data, and finish() tells the first mistake, with its place. Keys that nobody asks for are mistakes. Borrows the
/// document and the record of mistakes, which must outlive it. Thread-bound.
class StrictJson {
 public:
  struct Mistakes {
    std::string first;
    bool is_any = false;
  };
  StrictJson(const nlohmann::json& value, std::string place, Mistakes* mistakes)
      : value_(&value), place_(std::move(place)), mistakes_(mistakes) {}

  [[nodiscard]] bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  StrictJson at(const char* key) {
    asked_.emplace_back(key);
    if (has(key)) return {(*value_)[key], place_ + "/" + key, mistakes_};
    refuse(std::string("'") + key + "' is missing; calibrate again");
    return {none(), place_ + "/" + key, mistakes_};
  }
  double number(const char* key, double least, double most) { return at(key).as_number(least, most); }
  int integer(const char* key, int least, int most) { return static_cast<int>(at(key).as_number(least, most, true)); }
  bool flag(const char* key) {
    const StrictJson value = at(key);
    if (value.value_->is_boolean()) return value.value_->get<bool>();
    value.refuse("is not true or false; calibrate again");
    return false;
  }
  std::string text(const char* key, std::size_t longest = 4000) {
    const StrictJson value = at(key);
    if (value.value_->is_string() && value.value_->get_ref<const std::string&>().size() <= longest) {
      return value.value_->get<std::string>();
    }
    value.refuse("is not a text, or too long; calibrate again");
    return {};
  }
  /// Elements of a list of `least` to `most`; none when it is not.
  std::vector<StrictJson> list(const char* key, std::size_t least, std::size_t most) {
    return at(key).elements(least, most);
  }
  [[nodiscard]] std::vector<StrictJson> elements(std::size_t least, std::size_t most) const {
    if (!value_->is_array() || value_->size() < least || value_->size() > most) {
      refuse("is not a list of " + std::to_string(least) + " to " + std::to_string(most) + "; calibrate again");
      return {};
    }
    std::vector<StrictJson> elements;
    for (std::size_t i = 0; i < value_->size(); ++i) {
      elements.emplace_back((*value_)[i], place_ + "/" + std::to_string(i), mistakes_);
    }
    return elements;
  }
  std::vector<double> numbers(const char* key, std::size_t least, std::size_t most) {
    std::vector<double> numbers;
    for (const StrictJson& element : list(key, least, most)) numbers.push_back(element.as_number(-1e9, 1e9));
    return numbers;
  }
  [[nodiscard]] double as_number(double least, double most, bool is_whole = false) const {
    if (value_->is_number() && (!is_whole || value_->is_number_integer())) {
      const double number = value_->get<double>();
      if (number >= least && number <= most) return number;
    }
    refuse("is not a" + std::string(is_whole ? " whole" : "") + " number from " + std::to_string(least) + " to " +
           std::to_string(most) + "; calibrate again");
    return least;
  }
  [[nodiscard]] std::string as_text(std::size_t longest = 4000) const {
    if (value_->is_string() && value_->get_ref<const std::string&>().size() <= longest)
      return value_->get<std::string>();
    refuse("is not a text, or too long; calibrate again");
    return {};
  }
  /// To be called once all keys have been asked for.
  void refuse_other_keys() const {
    if (!value_->is_object()) return refuse("is not an object; calibrate again");
    for (const auto& [key, value] : value_->items()) {
      bool is_known = false;
      for (const std::string& asked : asked_) is_known = is_known || asked == key;
      if (!is_known) refuse("has a key that is not known, '" + key.substr(0, 60) + "'; remove it");
    }
  }
  void refuse(const std::string& what) const {
    if (!mistakes_->is_any) mistakes_->first = place_ + ": " + what;
    mistakes_->is_any = true;
  }

 private:
  static const nlohmann::json& none() {
    static const nlohmann::json json;
    return json;
  }
  const nlohmann::json* value_;
  std::string place_;
  Mistakes* mistakes_;
  std::vector<std::string> asked_;
};

/// kBadData  it is no JSON, and where; `name` says what, `remedy` what to do about it.
Result<nlohmann::json> parse_document(std::string_view text, const std::string& name, std::string_view remedy);

/// An Eigen matrix as a list of its rows.
template <typename Matrix>
nlohmann::ordered_json rows_of(const Matrix& matrix) {
  auto rows = nlohmann::ordered_json::array();
  for (long r = 0; r < matrix.rows(); ++r) {
    auto row = nlohmann::ordered_json::array();
    for (long c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace cyclorama
