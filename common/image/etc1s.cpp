// SPDX-License-Identifier: Apache-2.0
#include "common/image/etc1s.h"

#include <algorithm>
#include <utility>

namespace cyclorama {
namespace {

/// ETC1's modifiers by brightness and selector, the latter from dark to light.
constexpr std::array<std::array<int, 4>, 8> kModifiers = {{{-8, -2, 2, 8},
                                                           {-17, -5, 5, 17},
                                                           {-29, -9, 9, 29},
                                                           {-42, -13, 13, 42},
                                                           {-60, -18, 18, 60},
                                                           {-80, -24, 24, 80},
                                                           {-106, -33, 33, 106},
                                                           {-183, -47, 47, 183}}};
constexpr std::uint32_t kMaxRun = 63;  ///< Symbol for a run whose length is stored after it.
constexpr std::uint32_t kMinRun = 3;

Error damaged(const char* what) {
  return Error(ErrorCode::kBadData, std::string("the KTX2 texture's ") + what + " are damaged; export it again");
}

/// The most recently used selectors. A selector that is used again moves half way to the front.
class History {
 public:
  explicit History(std::size_t size) : selectors_(size, 0), rover_(size / 2) {}
  [[nodiscard]] std::size_t size() const { return selectors_.size(); }
  void add(std::uint32_t selector) {
    if (selectors_.empty()) return;
    selectors_[rover_++] = selector;
    if (rover_ == selectors_.size()) rover_ = selectors_.size() / 2;
  }
  /// Returns the selector at `place`, and moves it half way to the front. Precondition: `place` is below size().
  std::uint32_t use(std::size_t place) {
    const std::uint32_t used = selectors_[place];
    if (place > 0) std::swap(selectors_[place / 2], selectors_[place]);
    return used;
  }

 private:
  std::vector<std::uint32_t> selectors_;
  std::size_t rover_;
};

}  // namespace

/// Reads the blocks of one slice, row by row. Borrows the codebook and the bytes. Thread-bound.
class Etc1sCodebook::Slice {
 public:
  Slice(const Etc1sCodebook& codebook, std::span<const std::byte> bytes, std::size_t columns)
      : codebook_(codebook), bits_(bytes), history_(codebook.history_size_) {
    for (auto& row : endpoints_) row.resize(columns);
    predictions_.resize(columns);
  }

  Result<Block> next(std::size_t column, std::size_t row) {
    TRY_ASSIGN(const std::uint32_t endpoint, next_endpoint(column, row));
    TRY_ASSIGN(const std::uint32_t selector, next_selector());
    if (bits_.overran()) return damaged("blocks");
    return Block{endpoint, selector};
  }

 private:
  /// A symbol predicts the endpoints of 2x2 blocks, with two bits for each; even rows also read those of the row below.
  Result<std::uint32_t> prediction_of(std::size_t column, std::size_t row) {
    if (row % 2 == 0 && column % 2 == 0) {
      constexpr std::uint32_t kRepeat = 256;
      if (repeats_ > 0) {
        --repeats_;
      } else if (const std::uint32_t symbol = codebook_.prediction_.next(&bits_); symbol == kRepeat) {
        repeats_ = bits_.take_groups(4) + kMinRun - 1;
      } else if (symbol < kRepeat) {
        last_prediction_ = symbol;
      } else {
        return damaged("blocks");
      }
      predictions_[column] = last_prediction_;
    }
    const std::size_t shift = 4 * (row % 2) + 2 * (column % 2);
    return predictions_[column - column % 2] >> shift & 3u;
  }

  Result<std::uint32_t> next_endpoint(std::size_t column, std::size_t row) {
    TRY_ASSIGN(const std::uint32_t prediction, prediction_of(column, row));
    enum : std::uint32_t { kLeft, kAbove, kAboveLeft };
    std::vector<std::uint32_t>& here = endpoints_[row % 2];
    const std::vector<std::uint32_t>& above = endpoints_[1 - row % 2];
    if ((prediction == kLeft || prediction == kAboveLeft) && column == 0) return damaged("blocks");
    if ((prediction == kAbove || prediction == kAboveLeft) && row == 0) return damaged("blocks");
    if (prediction == kAbove) {
      last_endpoint_ = above[column];
    } else if (prediction == kAboveLeft) {
      last_endpoint_ = above[column - 1];
    } else if (prediction != kLeft) {
      const std::uint32_t step = codebook_.endpoint_step_.next(&bits_);
      const auto count = static_cast<std::uint32_t>(codebook_.endpoints_.size());
      if (step >= count) return damaged("blocks");
      last_endpoint_ = (last_endpoint_ + step) % count;
    }
    here[column] = last_endpoint_;
    return last_endpoint_;
  }

  Result<std::uint32_t> next_selector() {
    const auto count = static_cast<std::uint32_t>(codebook_.selectors_.size());
    if (run_ > 0) {
      --run_;
      return history_.use(0);
    }
    const std::uint32_t symbol = codebook_.selector_.next(&bits_);
    if (symbol < count) {
      history_.add(symbol);
      return symbol;
    }
    if (history_.size() == 0 || symbol == BasisHuffman::kNone) return damaged("blocks");
    const std::size_t place = symbol - count;
    if (place < history_.size()) return history_.use(place);
    if (place > history_.size()) return damaged("blocks");
    const std::uint32_t run = codebook_.run_.next(&bits_);
    if (run > kMaxRun) return damaged("blocks");
    run_ = kMinRun - 1 + (run == kMaxRun ? bits_.take_groups(7) : run);
    return history_.use(0);
  }

  const Etc1sCodebook& codebook_;
  BasisBits bits_;
  History history_;
  std::array<std::vector<std::uint32_t>, 2> endpoints_;  ///< Endpoints of even and of odd rows.
  std::vector<std::uint32_t> predictions_;               ///< Predictions at even columns.
  std::uint32_t last_prediction_ = 0;
  std::uint32_t repeats_ = 0;
  std::uint32_t last_endpoint_ = 0;
  std::uint32_t run_ = 0;  ///< Number of following blocks that also have the history's first selector.
};

Status Etc1sCodebook::read_endpoints(const Etc1sSource& source) {
  BasisBits bits(source.endpoints);
  std::array<BasisHuffman, 3> steps;  // Three codes, used after dark, middle and light colours.
  for (BasisHuffman& step : steps) {
    TRY_ASSIGN(step, BasisHuffman::read(&bits));
  }
  TRY_ASSIGN(const BasisHuffman brightness_step, BasisHuffman::read(&bits));
  const bool is_grey = bits.take(1) != 0;
  Endpoint last{{16, 16, 16}, 0};
  for (std::size_t i = 0; i < source.endpoint_count; ++i) {
    const std::uint32_t brighter = brightness_step.next(&bits);
    last.brightness = static_cast<std::uint8_t>((last.brightness + brighter) & 7u);
    bool is_good = brighter != BasisHuffman::kNone;
    for (std::size_t c = 0; c < (is_grey ? 1 : 3); ++c) {
      const std::size_t range = last.colour[c] <= 9 ? 0 : last.colour[c] <= 21 ? 1 : 2;
      const std::uint32_t step = steps[range].next(&bits);
      is_good = is_good && step != BasisHuffman::kNone;
      last.colour[c] = static_cast<std::uint8_t>((last.colour[c] + step) & 31u);
    }
    if (is_grey) last.colour[1] = last.colour[2] = last.colour[0];
    if (!is_good || bits.overran()) return damaged("colours");
    endpoints_.push_back(last);
  }
  return Done{};
}

Status Etc1sCodebook::read_selectors(const Etc1sSource& source) {
  BasisBits bits(source.selectors);
  if (bits.take(2) != 0) return damaged("selectors");  // Global and hybrid codebooks were never part of KTX.
  const bool is_raw = bits.take(1) != 0;
  BasisHuffman change;
  if (!is_raw) {
    TRY_ASSIGN(change, BasisHuffman::read(&bits));
  }
  std::uint32_t selector = 0;
  for (std::size_t i = 0; i < source.selector_count; ++i) {
    for (std::uint32_t row = 0; row < 4; ++row) {
      const bool is_whole = is_raw || i == 0;
      const std::uint32_t value = is_whole ? bits.take(8) : change.next(&bits);
      if (value > 255 || bits.overran()) return damaged("selectors");
      if (is_whole) selector &= ~(255u << 8 * row);
      selector ^= value << 8 * row;
    }
    selectors_.push_back(selector);
  }
  return Done{};
}

Status Etc1sCodebook::read_tables(const Etc1sSource& source) {
  BasisBits bits(source.tables);
  for (BasisHuffman* const code : {&prediction_, &endpoint_step_, &selector_, &run_}) {
    TRY_ASSIGN(*code, BasisHuffman::read(&bits));
  }
  history_size_ = bits.take(13);
  return bits.overran() ? Status(damaged("tables")) : Status(Done{});
}

Result<Etc1sCodebook> Etc1sCodebook::read(const Etc1sSource& source) {
  Etc1sCodebook codebook;
  TRY(codebook.read_endpoints(source));
  TRY(codebook.read_selectors(source));
  TRY(codebook.read_tables(source));
  return codebook;
}

void Etc1sCodebook::paint(const Block& block, int x, int y, Target target, RgbaImage* ret_image) const {
  const Endpoint& endpoint = endpoints_[block.endpoint];
  std::array<std::array<std::uint8_t, 3>, 4> colours;
  for (std::size_t s = 0; s < 4; ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int base = endpoint.colour[c] << 3 | endpoint.colour[c] >> 2;
      colours[s][c] = static_cast<std::uint8_t>(std::clamp(base + kModifiers[endpoint.brightness][s], 0, 255));
    }
  }
  const std::uint32_t selector = selectors_[block.selector];
  for (int row = 0; row < std::min(4, ret_image->height() - y); ++row) {
    for (int column = 0; column < std::min(4, ret_image->width() - x); ++column) {
      const std::array<std::uint8_t, 3>& colour = colours[selector >> (8 * row + 2 * column) & 3u];
      std::uint8_t* const pixel = ret_image->at(x + column, y + row);
      if (target == Target::kAlpha) {
        pixel[3] = colour[1];
      } else {
        std::copy(colour.begin(), colour.end(), pixel);
      }
    }
  }
}

Status Etc1sCodebook::decode(std::span<const std::byte> slice, Target target, RgbaImage* ret_image) const {
  if (endpoints_.empty() || selectors_.empty()) return damaged("codebooks");
  const int columns = (ret_image->width() + 3) / 4;
  const int rows = (ret_image->height() + 3) / 4;
  Slice blocks(*this, slice, static_cast<std::size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      TRY_ASSIGN(const Block block, blocks.next(static_cast<std::size_t>(column), static_cast<std::size_t>(row)));
      paint(block, 4 * column, 4 * row, target, ret_image);
    }
  }
  return Done{};
}

}  // namespace cyclorama
