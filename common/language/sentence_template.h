// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cyclorama {

/// A text with places for arguments, in fmt's notation: "{} of {:.1f} GB are free.", "{1}: {0}", "{name}". A value.
class SentenceTemplate {
 public:
  explicit SentenceTemplate(std::string_view text);

  [[nodiscard]] bool has_arguments() const { return !places_.empty(); }
  /// Number of letters outside of arguments. Of two templates that match, the one with more of them is the better.
  [[nodiscard]] int letters() const;
  /// True for an argument that is written with decimals.
  [[nodiscard]] bool is_decimal(std::size_t argument) const;

  /// Returns the arguments with which this template becomes `sentence`, in the order of their numbers; nothing if it
  /// cannot. Each argument is as short as possible, and the last one ends where the text after it begins.
  [[nodiscard]] std::optional<std::vector<std::string>> arguments_of(std::string_view sentence) const;
  /// Fills the places. Places without an argument stay empty.
  [[nodiscard]] std::string filled(const std::vector<std::string>& arguments) const;

 private:
  struct Place {
    std::size_t argument = 0;
    bool is_decimal = false;
  };
  std::vector<std::string> texts_;  ///< One more than places: what stands before, between and after them.
  std::vector<Place> places_;
};

}  // namespace cyclorama
