// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/reach_writer.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/file.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::StartsWith;

struct WriterFixture {
  FakeClock clock;
  std::filesystem::path folder;
  std::unique_ptr<Sessions> sessions;

  WriterFixture() {
    std::string name = (std::filesystem::temp_directory_path() / "reach-writer-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    folder = name;
    std::filesystem::create_directories(folder / "settings");
    sessions = std::make_unique<Sessions>(clock, folder / "settings/operator-pin");
  }
  ~WriterFixture() { std::filesystem::remove_all(folder); }
  WriterFixture(const WriterFixture&) = delete;
  WriterFixture& operator=(const WriterFixture&) = delete;

  [[nodiscard]] ReachWriter writer(bool has_mdns = false) const {
    return {{folder / "reach.json", 8443, "4F:A1", has_mdns, MuseumState{folder}}, sessions.get()};
  }
  [[nodiscard]] PageReach written() const {
    const auto text = read_text_file(folder / "reach.json", 1 << 16);
    CHECK(text);
    const auto reach = parse_page_reach(*text, "reach.json");
    CHECK(reach);
    return *reach;
  }
};

TEST(ReachWriter, writes_whether_there_is_a_pin_and_when_the_page_answered) {
  WriterFixture museum;
  ReachWriter writer = museum.writer();
  ASSERT_TRUE(writer.write(false, museum.clock.now()));
  EXPECT_FALSE(museum.written().has_pin);
  EXPECT_EQ(museum.written().answered_at, TimePoint{});
  EXPECT_EQ(museum.written().fingerprint, "4F:A1");
  ASSERT_TRUE(write_file_atomically(museum.folder / "settings/operator-pin", std::string_view("x")));
  ASSERT_TRUE(
      write_file_atomically(museum.folder / "settings/site.toml", std::string_view("[farm]\nmuseum = \"hall-3\"\n")));
  ASSERT_TRUE(writer.write(true, museum.clock.now()));
  EXPECT_TRUE(museum.written().has_pin);
  EXPECT_EQ(museum.written().name, "hall-3");
  const bool is_connected = !outside_addresses().empty();
  EXPECT_EQ(museum.written().answered_at, is_connected ? museum.clock.now() : TimePoint{});
}

TEST(ReachWriter, renews_the_walls_code_every_ten_minutes) {
  WriterFixture museum;
  ReachWriter writer = museum.writer();
  ASSERT_TRUE(writer.write(true, museum.clock.now()));
  const std::string first = museum.written().wall_code;
  EXPECT_EQ(first.size(), 16u);
  museum.clock.advance(9min);
  ASSERT_TRUE(writer.write(true, museum.clock.now()));
  EXPECT_EQ(museum.written().wall_code, first);
  museum.clock.advance(1min);
  ASSERT_TRUE(writer.write(true, museum.clock.now()));
  EXPECT_NE(museum.written().wall_code, first);
}

TEST(ReachWriter, lists_addresses_that_browsers_accept) {
  WriterFixture museum;
  ASSERT_TRUE(museum.writer(true).write(true, museum.clock.now()));
  const PageReach reach = museum.written();
  if (outside_addresses().empty()) {
    EXPECT_TRUE(reach.addresses.empty());
    GTEST_SKIP() << "this computer has no outside address";
  }
  for (const std::string& address : reach.addresses) {
    EXPECT_THAT(address, StartsWith("https://"));
    EXPECT_THAT(address, EndsWith(":8443/"));
  }
  EXPECT_THAT(reach.addresses.back(), EndsWith(".local:8443/"));
  in6_addr six{};
  for (const std::string& address : outside_addresses()) {
    const bool is_v6 = ::inet_pton(AF_INET6, address.c_str(), &six) == 1;
    EXPECT_FALSE(is_v6 && IN6_IS_ADDR_LINKLOCAL(&six)) << address;
  }
}

TEST(ReachWriter, reports_a_file_that_cannot_be_written) {
  WriterFixture museum;
  std::filesystem::create_directories(museum.folder / "reach.json/x");
  EXPECT_FALSE(museum.writer().write(true, museum.clock.now()));
}

}  // namespace
}  // namespace cyclorama::operations
