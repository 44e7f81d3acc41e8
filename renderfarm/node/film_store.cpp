// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/film_store.h"

#include <algorithm>
#include <utility>

namespace cyclorama {
namespace {

std::size_t bytes_of(const Film& film) {
  return film.sum.data().size_bytes() + film.square.data().size_bytes() + film.samples.data().size_bytes();
}

}  // namespace

FilmStore::Kept FilmStore::take(const Visit& visit, const std::string& picture, const PixelRect& tile) {
  const auto found = visits_.find(visit);
  if (found == visits_.end() || found->second.name != picture) return {};
  const auto kept = found->second.tiles.find(tile);
  if (kept == found->second.tiles.end()) return {};
  Kept taken = std::move(kept->second);
  found->second.tiles.erase(kept);
  bytes_ -= bytes_of(taken.film);
  return taken;
}

void FilmStore::put(const Visit& visit, const std::string& picture, const PixelRect& tile, Kept kept) {
  auto place = visits_.try_emplace(visit).first;
  if (place->second.name != picture) {
    drop(place);
    place = visits_.try_emplace(visit).first;
    place->second.name = picture;
  }
  place->second.used = ++uses_;
  const std::size_t bytes = bytes_of(kept.film);
  while (bytes_ + bytes > most_bytes_) {
    const auto oldest = std::ranges::min_element(visits_, {}, [](const auto& entry) { return entry.second.used; });
    if (oldest == place) return;
    drop(oldest);
  }
  Kept& slot = place->second.tiles[tile];
  bytes_ = bytes_ - bytes_of(slot.film) + bytes;
  slot = std::move(kept);
}

void FilmStore::forget(const Visit& visit) {
  if (const auto found = visits_.find(visit); found != visits_.end()) drop(found);
}

void FilmStore::forget_link(LinkId link) {
  for (auto visit = visits_.lower_bound({link, 0}); visit != visits_.end() && visit->first.link == link;) {
    visit = drop(visit);
  }
}

FilmStore::Pictures::iterator FilmStore::drop(Pictures::iterator visit) {
  for (const auto& [tile, kept] : visit->second.tiles) bytes_ -= bytes_of(kept.film);
  return visits_.erase(visit);
}

}  // namespace cyclorama
