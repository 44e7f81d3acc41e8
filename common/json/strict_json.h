// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Reads JSON strictly, like the settings (common/config): after a mistake, reading continues with a harmless value, so
/// that code needs no branches, and Mistakes keeps the first mistake with its position. Keys that were never requested
/// are mistakes. Borrows the document and the record of mistakes, which must outlive it. Thread-bound.
class StrictJson {
 public:
  struct Mistakes {
    /// `remedy`, such as "calibrate again", is appended to each mistake that names none.
    explicit Mistakes(std::string its_remedy) : remedy(std::move(its_remedy)) {}
    /// Returns kBadData with the first mistake, if there is one; `name` stands for the file in errors.
    [[nodiscard]] Status status(const std::string& name) const;

    std::string remedy;
    std::string first;
    bool is_any = false;
  };
  StrictJson(const nlohmann::json& value, Mistakes* mistakes) : StrictJson(value, "", mistakes) {}

  [[nodiscard]] bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  StrictJson at(const char* key);
  double number(const char* key, double min, double max) { return at(key).as_number(min, max); }
  int integer(const char* key, int min, int max) { return static_cast<int>(at(key).as_number(min, max, true)); }
  bool flag(const char* key);
  std::string text(const char* key, std::size_t longest = 4000) { return at(key).as_text(longest); }
  /// Returns the elements of a list of `min` to `max` elements. If the value is anything else, records a mistake and
  /// returns an empty list.
  std::vector<StrictJson> list(const char* key, std::size_t min, std::size_t max) { return at(key).elements(min, max); }
  [[nodiscard]] std::vector<StrictJson> elements(std::size_t min, std::size_t max) const;
  std::vector<double> numbers(const char* key, std::size_t min, std::size_t max);
  [[nodiscard]] double as_number(double min, double max, bool is_whole = false) const;
  [[nodiscard]] std::string as_text(std::size_t longest = 4000) const;

  /// Reads the key `version`. A number other than `version` is a mistake that names both.
  void require_version(int version);
  /// Records a mistake for each key that was not requested. To be called after all keys were requested.
  void refuse_other_keys() const;
  /// Records a mistake at this value. `what` includes the remedy.
  void refuse(const std::string& what) const;

 private:
  StrictJson(const nlohmann::json& value, std::string path, Mistakes* mistakes)
      : value_(&value), path_(std::move(path)), mistakes_(mistakes) {}
  void refuse_with_remedy(const std::string& what) const { refuse(what + "; " + mistakes_->remedy); }

  const nlohmann::json* value_;
  std::string path_;  ///< JSON pointer (RFC 6901); empty: the document.
  Mistakes* mistakes_;
  std::vector<std::string> requested_;
};

/// Parses a JSON document. Errors: kBadData with the position if the text is not JSON; `name` stands for the file,
/// `remedy` is appended.
Result<nlohmann::json> parse_document(std::string_view text, const std::string& name, std::string_view remedy);

/// Returns an Eigen matrix as a list of its rows.
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
