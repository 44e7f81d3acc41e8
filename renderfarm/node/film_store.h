// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>

#include "common/image/pixel_rect.h"
#include "renderfarm/node/link_id.h"
#include "renderfarm/render/film.h"

namespace cyclorama::node {

/// The sums of pictures at rest, one picture per session, tile by tile, so that a node need not render a sample twice.
/// What was forgotten is rendered again: a lost film costs time and changes no pixel. Thread-bound.
class FilmStore {
 public:
  struct Kept {
    render::Film film{};
    int samples = 0;  ///< Asked for, per pixel.
  };
  /// Coordinators number their sessions each for itself.
  struct Session {
    LinkId link = 0;
    std::uint64_t session = 0;
    friend auto operator<=>(const Session&, const Session&) = default;
  };
  /// Twenty bytes a pixel are kept, `most_bytes` in all.
  explicit FilmStore(std::size_t max_bytes = std::size_t{1} << 30) : max_bytes_(max_bytes) {}

  /// Takes the film out; an empty one when it has none of that very picture and tile. `picture` names all that decides
  /// the samples: scene, view, knobs.
  [[nodiscard]] Kept take(const Session& session, const std::string& picture, const PixelRect& tile);
  /// Forgets other pictures of the session, and, if memory is short, other sessions, or, if that does not help, this film.
  void put(const Session& session, const std::string& picture, const PixelRect& tile, Kept kept);
  /// The visitor moves, or has gone.
  void forget(const Session& session);
  /// The coordinator has gone.
  void forget_link(LinkId link);

  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Picture {
    std::string name;
    std::map<PixelRect, Kept> tiles;
    std::uint64_t used = 0;  ///< Grows: the smallest was used longest ago.
  };
  using Pictures = std::map<Session, Picture>;
  Pictures::iterator drop(Pictures::iterator session);

  const std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t uses_ = 0;
  Pictures sessions_;
};

}  // namespace cyclorama::node
