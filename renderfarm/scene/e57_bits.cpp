// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/e57_bits.h"

#include <fmt/format.h>

#include <bit>
#include <limits>

#include "common/base/text.h"

namespace cyclorama::scene {

Result<E57Field> E57Field::of(const E57Node& node) {
  const auto damaged = [&](const char* what) {
    return Error(ErrorCode::kBadData, fmt::format("the field '{}' of its points {}", printable(node.name), what));
  };
  E57Field field;
  field.name_ = node.name;
  const std::string_view type = node.attribute("type");
  if (type == "Float") {
    const bool is_single = node.attribute("precision") == "single";
    field.kind_ = is_single ? Kind::kFloat32 : Kind::kFloat64;
    field.bits_ = is_single ? 32 : 64;
    field.minimum_ = node.number("minimum").value_or(0.0);
    field.maximum_ = node.number("maximum").value_or(0.0);
    return field;
  }
  if (type != "Integer" && type != "ScaledInteger") return damaged("is neither a number nor a known type");
  const auto bound_of = [&](const char* name, std::int64_t otherwise) -> std::optional<std::int64_t> {
    if (node.attribute(name).empty()) return otherwise;
    return parse_integer(node.attribute(name));
  };
  const auto low = bound_of("minimum", std::numeric_limits<std::int64_t>::min());
  const auto high = bound_of("maximum", std::numeric_limits<std::int64_t>::max());
  if (!low || !high || *low > *high) return damaged("has no range of whole numbers");
  field.raw_minimum_ = *low;
  field.bits_ = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low)));
  if (type == "ScaledInteger") {
    field.scale_ = node.number("scale").value_or(1.0);
    field.offset_ = node.number("offset").value_or(0.0);
  }
  field.minimum_ = field.scale_ * static_cast<double>(*low) + field.offset_;
  field.maximum_ = field.scale_ * static_cast<double>(*high) + field.offset_;
  return field;
}

std::uint64_t E57Field::available() const {
  if (bits_ == 0) return std::numeric_limits<std::uint64_t>::max();
  return (8 * std::uint64_t{pending_.size()} - taken_bits_) / static_cast<std::uint64_t>(bits_);
}

double E57Field::next() {
  std::uint64_t raw = 0;
  for (int done = 0; done < bits_;) {
    const auto at_bit = static_cast<int>(taken_bits_ % 8);
    const int some = std::min(bits_ - done, 8 - at_bit);
    const auto byte = static_cast<std::uint64_t>(pending_[taken_bits_ / 8]);
    raw |= (byte >> at_bit & ((1u << some) - 1u)) << done;
    done += some;
    taken_bits_ += static_cast<std::uint64_t>(some);
  }
  if (kind_ == Kind::kFloat32) return double{std::bit_cast<float>(static_cast<std::uint32_t>(raw))};
  if (kind_ == Kind::kFloat64) return std::bit_cast<double>(raw);
  const auto whole = static_cast<std::int64_t>(static_cast<std::uint64_t>(raw_minimum_) + raw);
  return scale_ * static_cast<double>(whole) + offset_;
}

void E57Field::forget_taken() {
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(taken_bits_ / 8));
  taken_bits_ %= 8;
}

}  // namespace cyclorama::scene
