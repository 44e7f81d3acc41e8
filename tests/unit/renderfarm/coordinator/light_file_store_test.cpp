// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/light_file_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string_view>

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

class LightFileStoreTest : public testing::Test {
 protected:
  LightFileStoreTest() {
    light.set_version(scene_distribution::sha256_of("light"));
    light.set_bytes(5);
  }
  static std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

  LightFileStore store;
  wire::LightVersion light;
};

TEST_F(LightFileStoreTest, keeps_a_file_that_came_in_pieces) {
  store.accept(light);
  const auto receipt = store.receive(light.version());
  ASSERT_TRUE(receipt) << receipt.error().message();
  ASSERT_TRUE((*receipt)->add(bytes("li")));
  EXPECT_FALSE(store.open(light.version())) << "not before it is complete";
  ASSERT_TRUE((*receipt)->add(bytes("ght")));
  ASSERT_TRUE((*receipt)->finish());
  for (int i = 0; i < 2; ++i) {
    const auto file = store.open(light.version());
    ASSERT_TRUE(file) << file.error().message();
    EXPECT_EQ(file->stamp.bytes, 5u);
    std::string read(5, ' ');
    EXPECT_EQ(::pread(file->fd.get(), read.data(), read.size(), 0), 5);
    EXPECT_EQ(read, "light");
  }
}

TEST_F(LightFileStoreTest, refuses_light_that_nobody_requested) {
  EXPECT_THAT(store.receive(light.version()).error().message(), HasSubstr("nobody requested"));
  EXPECT_EQ(store.open(light.version()).error().code(), ErrorCode::kNotFound);
}

TEST_F(LightFileStoreTest, refuses_other_bytes_and_takes_the_right_ones_afterwards) {
  store.accept(light);
  for (const std::string_view wrong : {"lights", "lighT", "ligh", ""}) {
    const auto receipt = store.receive(light.version());
    ASSERT_TRUE(receipt);
    const Status added = (*receipt)->add(bytes(wrong));
    EXPECT_FALSE(added && (*receipt)->finish()) << wrong;
    EXPECT_FALSE(store.open(light.version()));
  }
  const auto receipt = store.receive(light.version());
  ASSERT_TRUE(receipt);
  EXPECT_TRUE((*receipt)->add(bytes("light")));
  EXPECT_TRUE((*receipt)->finish());
}

}  // namespace
}  // namespace cyclorama::coordinator
