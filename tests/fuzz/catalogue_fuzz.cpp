// SPDX-License-Identifier: Apache-2.0
/// Any sentence of a peer and any Accept-Language give some text; a template gives back what was filled in.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/check.h"
#include "common/language/catalogue.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const Catalogue& catalogue : Catalogue::all()) static_cast<void>(catalogue.sentence(text));
  static_cast<void>(best_language(text));
  const std::size_t half = size / 2;
  const SentenceTemplate sentence(text.substr(0, half));
  if (const auto arguments = sentence.arguments_of(text.substr(half)))
    CHECK(sentence.filled(*arguments) == text.substr(half));
  return 0;
}
