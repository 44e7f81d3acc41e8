// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/sentences.h"

#include <algorithm>

#include "common/base/text.h"

namespace cyclorama::provision {
namespace {

constexpr std::size_t kMaxSentences = 100;
constexpr std::size_t kMaxSentenceLength = 2000;

}  // namespace

bool read_sentence(const nlohmann::ordered_json& json, const char* key, std::string* ret) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return false;
  *ret = found->get<std::string>();
  return ret->size() <= kMaxSentenceLength && printable(*ret, kMaxSentenceLength) == *ret;
}

bool read_sentences(const nlohmann::ordered_json& json, const char* key, std::vector<std::string>* ret) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() > kMaxSentences) return false;
  return std::all_of(found->begin(), found->end(), [&](const nlohmann::ordered_json& one) {
    if (!one.is_string()) return false;
    ret->push_back(one.get<std::string>());
    return ret->back().size() <= kMaxSentenceLength && printable(ret->back(), kMaxSentenceLength) == ret->back();
  });
}

std::vector<std::string> bounded_sentences(const std::vector<std::string>& sentences) {
  std::vector<std::string> some;
  for (const std::string& sentence : sentences) {
    // Leaves room for an ellipsis of three bytes.
    if (some.size() < kMaxSentences) some.push_back(printable(sentence, kMaxSentenceLength - 3));
  }
  return some;
}

}  // namespace cyclorama::provision
