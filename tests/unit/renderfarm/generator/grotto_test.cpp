// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/grotto.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>

#include "renderfarm/generator/chamber.h"
#include "tests/doubles/recording_sink.h"

namespace cyclorama::generator {
namespace {

bool always(double) { return true; }

std::map<std::string, RecordedFile> made(std::uint64_t triangles, std::uint32_t seed, int threads) {
  auto grotto = plan_grotto(triangles, seed);
  EXPECT_TRUE(grotto.has_value());
  if (!grotto) return {};
  RecordingSink sink;
  EXPECT_TRUE(generate(*grotto, sink, threads, always).has_value());
  return sink.files();
}

std::map<std::string, std::uint64_t> digests(const std::map<std::string, RecordedFile>& files) {
  std::map<std::string, std::uint64_t> digests;
  for (const auto& [name, file] : files) digests[name] = file.digest;
  return digests;
}

TEST(Grotto, has_nearly_as_many_triangles_as_requested_and_never_more) {
  for (const std::uint64_t asked :
       {10'000u, 10'001u, 12'345u, 50'000u, 333'333u, 1'000'000u, 6'000'000u, 25'000'000u, 60'000'000u}) {
    for (const std::uint32_t seed : {0u, 1u, 4'000'000'000u}) {
      const auto grotto = plan_grotto(asked, seed);
      ASSERT_TRUE(grotto.has_value()) << asked;
      EXPECT_LE(grotto->counts().triangles, asked);
      EXPECT_GE(static_cast<double>(grotto->counts().triangles), 0.98 * static_cast<double>(asked)) << asked;
    }
  }
}

TEST(Grotto, is_refused_below_and_above_its_range) {
  for (const std::uint64_t asked :
       {std::uint64_t{0}, std::uint64_t{9'999}, std::uint64_t{60'000'001}, ~std::uint64_t{0}}) {
    const auto grotto = plan_grotto(asked, 1);
    ASSERT_FALSE(grotto.has_value()) << asked;
    EXPECT_EQ(grotto.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(grotto.error().message(), testing::HasSubstr(std::to_string(asked)));
  }
}

TEST(Grotto, writes_the_announced_number_of_finite_vertices) {
  for (const std::uint64_t asked : {10'000u, 120'000u}) {
    const auto grotto = plan_grotto(asked, 5);
    ASSERT_TRUE(grotto.has_value());
    const auto files = made(asked, 5, 2);
    ASSERT_EQ(files.size(), grotto->parts.size());
    std::uint64_t triangles = 0;
    for (const auto& [name, file] : files) {
      SCOPED_TRACE(name);
      EXPECT_TRUE(file.finished);
      EXPECT_EQ(file.arrived.vertices, file.promised.vertices);
      EXPECT_EQ(file.arrived.triangles, file.promised.triangles);
      EXPECT_EQ(file.bad_numbers, 0u);
      EXPECT_EQ(file.bad_indices, 0u);
      triangles += file.arrived.triangles;
    }
    EXPECT_EQ(triangles, grotto->counts().triangles);
  }
}

TEST(Grotto, stays_inside_its_rock) {
  for (const auto& [name, file] : made(60'000, 9, 2)) {
    SCOPED_TRACE(name);
    constexpr float kRock = 1.2f;  // Depth of niches and overlaps behind the walls.
    EXPECT_GT(file.low[0], -kHalfLength - kRock);
    EXPECT_LT(file.high[0], kHalfLength + kRock);
    EXPECT_GT(file.low[1], -0.5f);
    EXPECT_LT(file.high[1], kTopHeight + kRock);
    EXPECT_GT(file.low[2], -kHalfDepth - kRock);
    EXPECT_LT(file.high[2], kCorridorEnd + kRock);
  }
}

TEST(Grotto, is_identical_for_any_number_of_threads) {
  const auto once = digests(made(40'000, 3, 1));
  EXPECT_EQ(digests(made(40'000, 3, 1)), once);
  EXPECT_EQ(digests(made(40'000, 3, 2)), once);
  EXPECT_EQ(digests(made(40'000, 3, 16)), once);
}

TEST(Grotto, differs_with_the_seed) {
  const auto one = digests(made(20'000, 1, 1));
  const auto two = digests(made(20'000, 2, 1));
  EXPECT_NE(one.at("altar_wall.ply"), two.at("altar_wall.ply"));
  EXPECT_NE(one.at("disciples.ply"), two.at("disciples.ply"));
}

TEST(Grotto, streams_geometry_row_by_row_at_any_size) {
  // The longest row of 60 M triangles; a thread holds a few of these at a time.
  const auto grotto = plan_grotto(kMaxTriangles, 1);
  ASSERT_TRUE(grotto.has_value());
  for (const Part& part : grotto->parts) {
    for (const Patch& patch : part.patches) EXPECT_LT(patch.columns, 20'000) << part.file;
  }
  for (const auto& [name, file] : made(500'000, 1, 2)) EXPECT_LT(file.max_call, 5'000u) << name;
}

class FailingSink final : public GeometrySink {
 public:
  explicit FailingSink(int files) : files_(files) {}
  Result<std::unique_ptr<GeometryFile>> open(const std::string& name, const GeometryCounts& counts) override {
    if (files_-- == 0) return Error(ErrorCode::kSystem, "writing '" + name + "': No space left on device");
    return inner_.open(name, counts);
  }

 private:
  std::atomic<int> files_;
  RecordingSink inner_;
};

TEST(Grotto, reports_why_a_file_could_not_be_written) {
  const auto grotto = plan_grotto(10'000, 1);
  ASSERT_TRUE(grotto.has_value());
  for (int n = 0; n < static_cast<int>(grotto->parts.size()); ++n) {
    for (const int threads : {1, 3}) {
      FailingSink sink(n);
      const Status status = generate(*grotto, sink, threads, always);
      ASSERT_FALSE(status.has_value()) << n;
      EXPECT_THAT(status.error().message(), testing::HasSubstr("No space left on device"));
    }
  }
}

TEST(Grotto, stops_when_cancelled) {
  const auto grotto = plan_grotto(20'000'000, 1);
  ASSERT_TRUE(grotto.has_value());
  RecordingSink sink;
  const Status status = generate(*grotto, sink, 2, [](double) { return false; });
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code(), ErrorCode::kUnavailable);
}

TEST(Grotto, reports_progress_up_to_one) {
  const auto grotto = plan_grotto(300'000, 1);
  ASSERT_TRUE(grotto.has_value());
  RecordingSink sink;
  std::vector<double> seen;
  ASSERT_TRUE(generate(*grotto, sink, 2, [&](double fraction) {
                seen.push_back(fraction);
                return true;
              }).has_value());
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GE(seen.front(), 0.0);
  EXPECT_EQ(seen.back(), 1.0);
}

}  // namespace
}  // namespace cyclorama::generator
