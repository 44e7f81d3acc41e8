// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/ordered_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <filesystem>
#include <mutex>

#include "common/base/file.h"
#include "common/base/unique_fd.h"

namespace cyclorama::node {
namespace {

using light_baking::LightStage;
using light_baking::PieceBytes;
using light_baking::PieceFolder;
using light_baking::StageWork;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::UnorderedElementsAre;

namespace fs = std::filesystem;

PieceBytes results_of(std::uint32_t piece) { return {std::byte{1}, static_cast<std::byte>(piece)}; }

class OrderedPiecesTest : public testing::Test {
 protected:
  OrderedPiecesTest() {
    fs::remove_all(folder);
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    node = UniqueFd(ends[0]);
    child = UniqueFd(ends[1]);
    work.compute = [this](std::uint32_t piece) -> Result<PieceBytes> {
      const std::lock_guard lock(mutex);
      computed.push_back(piece);
      return results_of(piece);
    };
    work.take = [this](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
      const std::lock_guard lock(mutex);
      if (!std::ranges::equal(bytes, results_of(piece))) return Error(ErrorCode::kBadData, "other results");
      taken.push_back(piece);
      return Done{};
    };
    other.begin("c0");
  }
  ~OrderedPiecesTest() override { fs::remove_all(folder); }

  void order(const std::string& text) const {
    ASSERT_EQ(::send(node.get(), text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
  }
  Status complete() {
    OrderedPieces pieces(folder, child.get(), [this](const std::string& line) {
      const std::lock_guard lock(mutex);
      lines.push_back(line);
    });
    TRY(pieces.begin("c0"));
    return pieces.complete(stage, work);
  }

  const fs::path folder = fs::path(testing::TempDir()) / "ordered_pieces_test";
  const LightStage stage{3, std::string(32, 'a'), 3};
  PieceFolder other{folder};  ///< The folder as another program sees it.
  UniqueFd node;
  UniqueFd child;
  StageWork work;
  std::mutex mutex;
  std::vector<std::uint32_t> computed;
  std::vector<std::uint32_t> taken;
  std::vector<std::string> lines;
};

TEST_F(OrderedPiecesTest, are_computed_when_ordered_and_reported_with_the_sum_of_their_file) {
  order("compute 3 2");
  order("compute 3 0");
  order("compute 3 0");
  order("compute 2 1");
  order("compute 3 99");
  order("nonsense");
  order("compute 3 1");
  ASSERT_TRUE(complete());
  EXPECT_THAT(computed, UnorderedElementsAre(0u, 1u, 2u)) << "each once, and none of another stage";
  EXPECT_THAT(taken, UnorderedElementsAre(0u, 1u, 2u));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0], "stage 3 " + stage.key + " 3 " + (folder / "c0").string());
  for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_THAT(lines[i], StartsWith("piece 3 "));
  EXPECT_EQ(other.load(stage, 2), results_of(2));
}

TEST_F(OrderedPiecesTest, that_were_kept_or_fetched_are_not_computed) {
  ASSERT_TRUE(other.save(stage, 0, results_of(0)));
  ASSERT_TRUE(other.save(stage, 2, results_of(2)));
  const fs::path fetched = other.file_of(3, 2);
  const auto bytes = *read_file(fetched, 1000);
  fs::remove(fetched);
  order("fetched 3 2");  // Nothing has come.
  order("fetched 3 1");
  order("compute 3 1");
  const auto take = work.take;
  work.take = [&](std::uint32_t piece, std::span<const std::byte> results) {
    if (piece == 1) {  // The file comes while another piece is computed.
      EXPECT_TRUE(write_file_atomically(fetched, bytes));
      order("fetched 3 2");
    }
    return take(piece, results);
  };
  ASSERT_TRUE(complete());
  EXPECT_THAT(computed, ElementsAre(1u));
  EXPECT_THAT(taken, ElementsAre(0u, 1u, 2u));
}

TEST_F(OrderedPiecesTest, whose_files_are_damaged_are_computed_when_ordered) {
  for (const std::uint32_t piece : {0u, 1u, 2u}) ASSERT_TRUE(other.save(stage, piece, results_of(piece)));
  ASSERT_TRUE(other.save(stage, 1, results_of(7)));  // Whole, but of no use.
  fs::resize_file(other.file_of(3, 2), 20);
  order("compute 3 1");
  order("compute 3 2");
  ASSERT_TRUE(complete());
  EXPECT_THAT(computed, UnorderedElementsAre(1u, 2u));
}

TEST_F(OrderedPiecesTest, end_with_the_node) {
  node = UniqueFd();
  const Status done = complete();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(done.error().message(), HasSubstr("the node that computed light has ended"));
  EXPECT_THAT(computed, IsEmpty());
}

}  // namespace
}  // namespace cyclorama::node
