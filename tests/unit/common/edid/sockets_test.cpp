// SPDX-License-Identifier: Apache-2.0
#include "common/edid/sockets.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/base/file.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;

class SocketsTest : public ::testing::Test {
 protected:
  SocketsTest() : drm_(fs::temp_directory_path() / fmt::format("drm-{}", ::getpid())) { fs::create_directories(drm_); }
  ~SocketsTest() override { fs::remove_all(drm_); }
  void add(const std::string& name, const std::string& status, const std::vector<std::uint8_t>& edid) const {
    fs::create_directories(drm_ / name);
    EXPECT_TRUE(write_file_atomically(drm_ / name / "status", std::string_view(status)));
    const std::string_view bytes(reinterpret_cast<const char*>(edid.data()), edid.size());
    EXPECT_TRUE(write_file_atomically(drm_ / name / "edid", bytes));
  }
  fs::path drm_;
};

TEST_F(SocketsTest, names_what_is_connected_with_its_serial) {
  add("card0-HDMI-A-2", "connected\n", fake_edid("EB-L1755U", 8, "X4K1"));
  add("card0-HDMI-A-1", "connected\n", {});
  add("card0-DP-1", "disconnected\n", {});
  add("card0-DP-2", "connected\n", fake_edid("", 8));
  fs::create_directories(drm_ / "card0");
  fs::create_directories(drm_ / "renderD128");
  const auto sockets = list_sockets(drm_);
  ASSERT_EQ(sockets.size(), 4U);
  EXPECT_EQ(sockets[0].connector, "DP-1");
  EXPECT_FALSE(sockets[0].is_connected);
  EXPECT_EQ(text_of_connected(sockets),
            "DP-2 (CYC 1234, no serial), HDMI-A-1 (no EDID), HDMI-A-2 (CYC EB-L1755U, serial \"X4K1\")");
}

TEST_F(SocketsTest, names_the_cards_if_there_are_several) {
  add("card0-DP-1", "connected\n", {});
  add("card1-DP-1", "connected\n", {});
  EXPECT_EQ(text_of_connected(list_sockets(drm_)), "card0 DP-1 (no EDID), card1 DP-1 (no EDID)");
}

TEST_F(SocketsTest, finds_nothing_on_a_computer_without_cards) {
  EXPECT_EQ(text_of_connected(list_sockets(drm_)), "nothing");
  EXPECT_EQ(text_of_connected(list_sockets(drm_ / "missing")), "nothing");
}

}  // namespace
}  // namespace cyclorama
