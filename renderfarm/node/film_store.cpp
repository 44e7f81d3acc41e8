// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/film_store.h"

#include <algorithm>
#include <utility>

namespace cyclorama::node {
namespace {

std::size_t bytes_of(const FilmStore::Kept& kept) {
  const render::Film& film = kept.film;
  return film.sum.data().size_bytes() + film.square.data().size_bytes() + film.samples.data().size_bytes() +
         kept.prior.data().size_bytes();
}

}  // namespace

FilmStore::Kept FilmStore::take(const Session& session, const std::string& picture, const PixelRect& tile) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(session);
  if (found == sessions_.end() || found->second.name != picture) return {};
  const auto kept = found->second.tiles.find(tile);
  if (kept == found->second.tiles.end()) return {};
  Kept taken = std::move(kept->second);
  found->second.tiles.erase(kept);
  bytes_ -= bytes_of(taken);
  return taken;
}

void FilmStore::put(const Session& session, const std::string& picture, const PixelRect& tile, Kept kept) {
  const std::lock_guard lock(mutex_);
  auto place = sessions_.try_emplace(session).first;
  if (place->second.name != picture) {
    drop(place);
    place = sessions_.try_emplace(session).first;
    place->second.name = picture;
  }
  place->second.used = ++uses_;
  const std::size_t bytes = bytes_of(kept);
  while (bytes_ + bytes > max_bytes_) {
    const auto oldest = std::ranges::min_element(sessions_, {}, [](const auto& entry) { return entry.second.used; });
    if (oldest == place) return;
    drop(oldest);
  }
  Kept& slot = place->second.tiles[tile];
  bytes_ = bytes_ - bytes_of(slot) + bytes;
  slot = std::move(kept);
}

void FilmStore::forget(const Session& session) {
  const std::lock_guard lock(mutex_);
  if (const auto found = sessions_.find(session); found != sessions_.end()) drop(found);
}

void FilmStore::forget_link(LinkId link) {
  const std::lock_guard lock(mutex_);
  for (auto session = sessions_.lower_bound({link, 0}); session != sessions_.end() && session->first.link == link;) {
    session = drop(session);
  }
}

std::size_t FilmStore::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

FilmStore::Pictures::iterator FilmStore::drop(Pictures::iterator session) {
  for (const auto& [tile, kept] : session->second.tiles) bytes_ -= bytes_of(kept);
  return sessions_.erase(session);
}

}  // namespace cyclorama::node
