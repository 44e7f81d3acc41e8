// SPDX-License-Identifier: Apache-2.0
/// Marks of texts for people, which scripts/texts collects. Header only, so that programs without a catalogue can use it.
#pragma once

namespace cyclorama {

/// Returns the English form for a count, for fmt::runtime(). Both forms are in the catalogues, and Catalogue::sentence()
/// takes the form of its language by the first whole number among the arguments.
[[nodiscard]] constexpr const char* plural(const char* one, const char* many, long long count) {
  return count == 1 ? one : many;
}

/// Marks a text in a source whose texts are otherwise not for people.
[[nodiscard]] constexpr const char* translatable(const char* english) { return english; }

}  // namespace cyclorama
