// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/film_store.h"

#include <gtest/gtest.h>

namespace cyclorama::node {
namespace {

constexpr PixelRect kLeft = {0, 0, 16, 16};
constexpr PixelRect kRight = {16, 0, 16, 16};
constexpr std::size_t kTileBytes = std::size_t{20} * 16 * 16;

FilmStore::Kept kept_of(int samples) { return {render::Film(16, 16, false), samples}; }

TEST(FilmStore, returns_what_it_has_of_the_same_picture_and_tile) {
  FilmStore films;
  films.put({1, 1}, "a", kLeft, kept_of(4));
  films.put({1, 1}, "a", kRight, kept_of(8));
  EXPECT_EQ(films.bytes(), 2 * kTileBytes);
  EXPECT_EQ(films.take({1, 2}, "a", kLeft).samples, 0);
  EXPECT_EQ(films.take({1, 1}, "b", kLeft).samples, 0);
  EXPECT_EQ(films.take({1, 1}, "a", {0, 0, 32, 16}).samples, 0);
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 4);
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 0) << "it was taken out";
  EXPECT_EQ(films.take({1, 1}, "a", kRight).samples, 8);
  EXPECT_EQ(films.bytes(), 0u);
}

TEST(FilmStore, keeps_one_picture_per_session) {
  FilmStore films;
  films.put({1, 1}, "a", kLeft, kept_of(4));
  films.put({1, 2}, "a", kLeft, kept_of(5));
  films.put({1, 1}, "b", kRight, kept_of(6));
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 0);
  EXPECT_EQ(films.bytes(), 2 * kTileBytes);
  films.forget({1, 1});
  films.forget({1, 7});
  EXPECT_EQ(films.take({1, 1}, "b", kRight).samples, 0);
  EXPECT_EQ(films.take({1, 2}, "a", kLeft).samples, 5);
}

TEST(FilmStore, keeps_sessions_of_two_coordinators_apart) {
  FilmStore films;
  films.put({1, 7}, "a", kLeft, kept_of(4));
  films.put({2, 7}, "b", kLeft, kept_of(5));
  films.put({2, 8}, "c", kLeft, kept_of(6));
  films.forget({2, 7});
  EXPECT_EQ(films.take({1, 7}, "a", kLeft).samples, 4);
  films.put({1, 7}, "a", kLeft, kept_of(4));
  films.forget_link(2);
  EXPECT_EQ(films.take({2, 8}, "c", kLeft).samples, 0);
  EXPECT_EQ(films.bytes(), kTileBytes);
  films.forget_link(1);
  EXPECT_EQ(films.bytes(), 0u);
}

TEST(FilmStore, replaces_a_tile_without_counting_it_twice) {
  FilmStore films;
  films.put({1, 1}, "a", kLeft, kept_of(4));
  films.put({1, 1}, "a", kLeft, kept_of(8));
  EXPECT_EQ(films.bytes(), kTileBytes);
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 8);
}

TEST(FilmStore, drops_the_least_recently_used_session_when_memory_is_short) {
  FilmStore films(2 * kTileBytes);
  films.put({1, 1}, "a", kLeft, kept_of(1));
  films.put({1, 2}, "a", kLeft, kept_of(2));
  films.put({1, 3}, "a", kLeft, kept_of(3));
  EXPECT_EQ(films.bytes(), 2 * kTileBytes);
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 0);
  films.put({1, 3}, "a", kRight, kept_of(4));
  EXPECT_EQ(films.take({1, 2}, "a", kLeft).samples, 0);
  films.put({1, 3}, "a", {32, 0, 16, 16}, kept_of(5));
  EXPECT_EQ(films.bytes(), 2 * kTileBytes) << "a picture that is larger than the store is kept in part";
  EXPECT_EQ(films.take({1, 3}, "a", kLeft).samples, 3);
}

TEST(FilmStore, keeps_nothing_without_memory) {
  FilmStore films(0);
  films.put({1, 1}, "a", kLeft, kept_of(1));
  EXPECT_EQ(films.take({1, 1}, "a", kLeft).samples, 0);
  EXPECT_EQ(films.bytes(), 0u);
}

}  // namespace
}  // namespace cyclorama::node
