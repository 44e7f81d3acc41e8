// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>

#include "common/image/pixel_rect.h"
#include "renderfarm/node/link_id.h"
#include "renderfarm/render/film.h"

namespace cyclorama {

/// The sums of pictures at rest, one picture per visit, tile by tile, so that a node need not render a sample twice.
/// What was forgotten is rendered again: a lost film costs time and changes no pixel. Thread-bound.
class FilmStore {
 public:
  struct Kept {
    Film film{};
    int samples = 0;  ///< Asked for, per pixel.
  };
  /// Heads number their visits each for itself.
  struct Visit {
    LinkId link = 0;
    std::uint64_t visit = 0;
    friend auto operator<=>(const Visit&, const Visit&) = default;
  };
  /// Twenty bytes a pixel are kept, `most_bytes` in all.
  explicit FilmStore(std::size_t most_bytes = std::size_t{1} << 30) : most_bytes_(most_bytes) {}

  /// Takes the film out; an empty one when it has none of that very picture and tile. `picture` names all that decides
  /// the samples: scene, view, knobs.
  [[nodiscard]] Kept take(const Visit& visit, const std::string& picture, const PixelRect& tile);
  /// Forgets other pictures of the visit, and, if memory is short, other visits, or, if that does not help, this film.
  void put(const Visit& visit, const std::string& picture, const PixelRect& tile, Kept kept);
  /// The visitor moves, or has gone.
  void forget(const Visit& visit);
  /// The head has gone.
  void forget_link(LinkId link);

  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Picture {
    std::string name;
    std::map<PixelRect, Kept> tiles;
    std::uint64_t used = 0;  ///< Grows: the smallest was used longest ago.
  };
  using Pictures = std::map<Visit, Picture>;
  Pictures::iterator drop(Pictures::iterator visit);

  const std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t uses_ = 0;
  Pictures visits_;
};

}  // namespace cyclorama
