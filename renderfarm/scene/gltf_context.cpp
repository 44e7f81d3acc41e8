// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_context.h"

#include <fmt/format.h>

#include <algorithm>

namespace cyclorama::scene {
namespace {

constexpr std::size_t kMaxNotes = 60;  // About a page; a longer list would hide the important notes.

}  // namespace

Status GltfBudget::take(std::string_view place, std::uint64_t count, std::size_t bytes_each) {
  if (bytes_each != 0 && count > left_bytes_ / bytes_each) {
    return Error(ErrorCode::kBadData,
                 fmt::format("{}: needs {} x {} bytes, and {} of {} MiB are left for this file; simplify the model, or "
                             "raise the memory limit",
                             place, count, bytes_each, left_bytes_ >> 20, (limit_bytes_ - withheld_bytes_) >> 20));
  }
  left_bytes_ -= count * bytes_each;
  return Done{};
}

void GltfBudget::earn(std::uint64_t stored) {
  const std::size_t earned =
      static_cast<std::size_t>(std::min<std::uint64_t>(stored, withheld_bytes_ / kBytesPerStored)) * kBytesPerStored;
  left_bytes_ += earned;
  withheld_bytes_ -= earned;
}

void GltfNotes::add(const std::string& sentence, std::string_view place) {
  const auto known = notes_.find(sentence);
  if (known != notes_.end()) {
    ++known->second.count;
  } else if (notes_.size() < kMaxNotes) {
    notes_.emplace(sentence, Occurrence{notes_.size(), 1, std::string(place)});
  } else {
    ++left_out_;
  }
}

std::vector<std::string> GltfNotes::sentences() const {
  std::vector<std::string> sentences(notes_.size());
  for (const auto& [sentence, occurrence] : notes_) {
    std::string& text = sentences[occurrence.order];
    text = sentence;
    if (occurrence.count > 1) {
      text += fmt::format(" ({} times, first at {})", occurrence.count, occurrence.first_place);
    } else if (!occurrence.first_place.empty()) {
      text += fmt::format(" ({})", occurrence.first_place);
    }
  }
  if (left_out_ > 0) sentences.push_back(fmt::format("{} more things were noted and are not listed here", left_out_));
  return sentences;
}

}  // namespace cyclorama::scene
