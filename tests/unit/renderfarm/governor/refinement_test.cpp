// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderfarm/governor/stored_light_front.h"

namespace cyclorama::governor {
namespace {

ParetoPoint point_of(double cost, double error, int samples) {
  ParetoPoint point;
  point.cost = cost;
  point.error = error;
  point.quality.render.samples = samples;
  return point;
}

ParetoFront plain_pareto_front() {
  return *ParetoFront::make({point_of(1, 1, 1), point_of(4, 0.25, 4), point_of(16, 0.0625, 16)});
}

std::vector<int> steps(Refinement refinement, double ms_per_sample = 0.01) {
  std::vector<int> ends;
  while (const auto range = refinement.next(ms_per_sample)) {
    EXPECT_EQ(range->first, refinement.samples());
    refinement.done(*range);
    ends.push_back(range->end);
  }
  EXPECT_TRUE(refinement.rests());
  return ends;
}

TEST(CutSamples, divides_every_range_at_the_same_positions) {
  EXPECT_TRUE(cut_samples({5, 5}, 64).empty());
  EXPECT_EQ(cut_samples({0, 1}, 64), (std::vector<SampleRange>{{0, 1}}));
  EXPECT_EQ(cut_samples({0, 5}, 64), (std::vector<SampleRange>{{0, 1}, {1, 2}, {2, 4}, {4, 5}}));
  EXPECT_EQ(cut_samples({32, 200}, 64), (std::vector<SampleRange>{{32, 64}, {64, 128}, {128, 192}, {192, 200}}));
  const auto whole = cut_samples({0, 1024}, 64);
  for (const int middle : {1, 2, 16, 64, 192, 960}) {
    auto both = cut_samples({0, middle}, 64);
    const auto rest = cut_samples({middle, 1024}, 64);
    both.insert(both.end(), rest.begin(), rest.end());
    EXPECT_EQ(both, whole) << middle;
  }
}

TEST(CutSamples, divides_a_picture_of_many_bounces_into_shorter_pieces_with_the_same_steps) {
  EXPECT_EQ(cut_samples({0, 3}, 1), (std::vector<SampleRange>{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(cut_samples({0, 14}, 4), (std::vector<SampleRange>{{0, 1}, {1, 2}, {2, 4}, {4, 8}, {8, 12}, {12, 14}}));
  for (const int max : {1, 2, 4, 8, 16, 32, 64}) {
    const auto whole = cut_samples({0, 320}, max);
    for (const int middle : {1, 2, 16, 64, 192, 256}) {
      auto both = cut_samples({0, middle}, max);
      const auto rest = cut_samples({middle, 320}, max);
      both.insert(both.end(), rest.begin(), rest.end());
      EXPECT_EQ(both, whole) << max << ", " << middle;
    }
  }
}

TEST(CutEvenly, divides_a_range_into_pieces_of_one_length) {
  EXPECT_TRUE(cut_evenly({5, 5}, 4).empty());
  EXPECT_EQ(cut_evenly({3, 5}, 4), (std::vector<SampleRange>{{3, 5}}));
  EXPECT_EQ(cut_evenly({3, 12}, 4), (std::vector<SampleRange>{{3, 7}, {7, 11}, {11, 12}}));
}

TEST(Refinement, doubles_the_samples_until_the_reference_and_then_rests) {
  const ParetoFront front = plain_pareto_front();
  EXPECT_EQ(steps(Refinement(front, front[1], 1024)), (std::vector<int>{8, 16, 32, 64, 128, 256, 512, 1024}));
  EXPECT_EQ(steps(Refinement(front, front[0], 100)), (std::vector<int>{2, 4, 8, 16, 32, 64, 100}));
  EXPECT_EQ(steps(Refinement(front, front[2], 1)), (std::vector<int>{1}));
  EXPECT_EQ(steps(Refinement(front, front[2], 7)), (std::vector<int>{7})) << "fewer than the moving picture had";
}

TEST(Refinement, takes_about_a_second_per_picture_when_samples_are_slow) {
  const ParetoFront front = plain_pareto_front();
  EXPECT_EQ(steps(Refinement(front, front[1], 320), 10.0), (std::vector<int>{8, 16, 32, 64, 128, 256, 320}));
  EXPECT_EQ(steps(Refinement(front, front[1], 320), 1e6), (std::vector<int>{8, 16, 32, 64, 128, 192, 256, 320}));
  EXPECT_EQ(steps(Refinement(front, front[1], 320), 0.0).back(), 320) << "speed unknown";
  EXPECT_EQ(steps(Refinement(front, front[1], 320), std::nan("")).back(), 320);
}

TEST(Refinement, ends_every_picture_but_the_last_at_a_cut) {
  const ParetoFront front = plain_pareto_front();
  for (const int reference : {3, 64, 65, 1000, render::kMaxSamples}) {
    const auto whole = cut_samples({0, reference}, 64);
    for (const double ms : {0.0, 0.1, 3.0, 1e9}) {
      for (const int end : steps(Refinement(front, front[0], reference), ms)) {
        EXPECT_TRUE(std::ranges::any_of(whole, [&](const SampleRange& piece) { return piece.end == end; })) << end;
      }
    }
  }
}

TEST(Refinement, starts_no_worse_than_the_moving_picture) {
  ParetoPoint denoised = point_of(2, 0.02, 2);
  denoised.quality.denoise = true;
  ParetoPoint small = point_of(1, 1.5, 1);
  small.quality.scale = 0.5;
  const ParetoFront front = *ParetoFront::make({small, point_of(1.5, 1, 1), denoised, point_of(64, 1.0 / 64, 64)});
  EXPECT_EQ(Refinement(front, front[2], 1024).next(0.0)->end, 64) << "50 plain samples err as much";
  EXPECT_EQ(Refinement(front, front[0], 1024).next(0.0)->end, 2);
  const ParetoFront only = *ParetoFront::make({denoised});
  EXPECT_EQ(Refinement(only, only[0], 1024).next(0.0)->end, 4) << "nothing to compare with";
}

TEST(Refinement, begins_with_stored_light_as_a_prior_that_counts_as_the_samples_of_its_error) {
  ParetoPoint small = point_of(0.1, 0.5, 1);
  small.quality.scale = 0.5;
  small.quality.render.stored_light = true;
  ParetoPoint stored = point_of(0.5, 0.02, 4);
  stored.quality.render.stored_light = true;
  const ParetoFront front = *ParetoFront::make({small, stored, point_of(64, 1.0 / 64, 64)});
  EXPECT_TRUE(uses_stored_light(front));
  const Refinement refinement(front, front[0], 1024);
  EXPECT_EQ(refinement.prior().samples, 4);
  EXPECT_NEAR(refinement.prior().weight, 50.0, 1e-9);
  EXPECT_FALSE(refinement.quality().render.stored_light);
  EXPECT_EQ(steps(refinement), (std::vector<int>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}));
  EXPECT_EQ(Refinement(plain_pareto_front(), plain_pareto_front()[0], 64).prior().samples, 0);
  EXPECT_FALSE(uses_stored_light(plain_pareto_front()));
  const ParetoFront only = *ParetoFront::make({stored});
  EXPECT_EQ(Refinement(only, only[0], 1024).prior().samples, 0) << "the error of paths is unknown";
}

TEST(Refinement, turns_off_what_would_bias_the_reference) {
  ParetoPoint best = point_of(1, 1, 4);
  best.quality.scale = 0.5;
  best.quality.denoise = true;
  best.quality.render.firefly_limit = 5.0f;
  best.quality.render.adaptive_error = 0.1f;
  best.quality.render.bounces = 3;
  best.quality.jpeg_quality = 93;
  best.quality.subsample_chroma = true;
  const ParetoFront front = *ParetoFront::make({best});
  const Refinement refinement(front, front[0], 256);
  const render::PictureQuality& quality = refinement.quality();
  EXPECT_EQ(quality.scale, 1.0);
  EXPECT_FALSE(quality.denoise);
  EXPECT_EQ(quality.render.firefly_limit, 0.0f);
  EXPECT_EQ(quality.render.adaptive_error, 0.0f);
  EXPECT_EQ(quality.render.bounces, 3);
  EXPECT_EQ(quality.render.sequence, 256);
  EXPECT_EQ(quality.jpeg_quality, 95);
  EXPECT_FALSE(quality.subsample_chroma);
}

}  // namespace
}  // namespace cyclorama::governor
