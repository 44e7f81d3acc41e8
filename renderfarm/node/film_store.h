// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "common/image/pixel_rect.h"
#include "renderfarm/node/link_id.h"
#include "renderfarm/render/film.h"

namespace cyclorama::node {

/// The sample sums of pictures at rest, one picture per session, tile by tile, so that a node need not render a sample
/// twice. A forgotten film is rendered again, which costs time but changes no pixel. Thread-safe.
class FilmStore {
 public:
  struct Kept {
    render::Film film{};
    int samples = 0;           ///< Requested samples per pixel.
    RadianceImage prior = {};  ///< Picture with stored light that the film began with; empty if there is none.
  };
  /// A session's identity. It contains the link, because each coordinator numbers its sessions independently.
  struct Session {
    LinkId link = 0;
    std::uint64_t session = 0;
    friend auto operator<=>(const Session&, const Session&) = default;
  };
  /// Keeps 20 bytes per pixel, or 32 with stored light, and at most `max_bytes` in all.
  explicit FilmStore(std::size_t max_bytes = std::size_t{1} << 30) : max_bytes_(max_bytes) {}

  /// Takes the film out of the store; returns an empty film if this picture and tile have none. `picture` names
  /// everything that determines the samples: scene, view and quality settings.
  [[nodiscard]] Kept take(const Session& session, const std::string& picture, const PixelRect& tile);
  /// Stores a film and forgets the session's other pictures. If memory is short, forgets other sessions, and finally
  /// this film.
  void put(const Session& session, const std::string& picture, const PixelRect& tile, Kept kept);
  /// Forgets a session whose picture moves again or that has ended.
  void forget(const Session& session);
  /// Forgets all sessions of a coordinator's stream that has ended.
  void forget_link(LinkId link);

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Picture {
    std::string name;
    std::map<PixelRect, Kept> tiles;
    std::uint64_t used = 0;  ///< Use counter; the smallest is the least recently used.
  };
  using Pictures = std::map<Session, Picture>;
  /// Precondition: the mutex is held.
  Pictures::iterator drop(Pictures::iterator session);

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::size_t bytes_ = 0;
  std::uint64_t uses_ = 0;
  Pictures sessions_;
};

}  // namespace cyclorama::node
