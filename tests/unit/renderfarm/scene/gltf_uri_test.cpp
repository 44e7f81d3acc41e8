// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_uri.h"

#include <gtest/gtest.h>

namespace cyclorama::scene {
namespace {

std::string text_of(const Result<std::vector<std::byte>>& bytes) {
  return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : bytes.error().message();
}

TEST(GltfUri, decodes_base64_with_and_without_padding) {
  EXPECT_EQ(text_of(decode_data_uri("data:application/octet-stream;base64,SGVsbG8=")), "Hello");
  EXPECT_EQ(text_of(decode_data_uri("data:application/gltf-buffer;base64,SGVsbG8")), "Hello");
  EXPECT_EQ(text_of(decode_data_uri("data:;base64,SGVsbA==")), "Hell");
  EXPECT_EQ(text_of(decode_data_uri("data:;base64,")), "");
  EXPECT_EQ(text_of(decode_data_uri("data:text/plain,He%6clo")), "Hello");
}

TEST(GltfUri, refuses_data_that_is_not_base64) {
  EXPECT_FALSE(decode_data_uri("data:;base64,SGV*bG8=").has_value());
  EXPECT_FALSE(decode_data_uri("data:;base64,S").has_value());
  EXPECT_FALSE(decode_data_uri("data:").has_value());
  EXPECT_FALSE(decode_data_uri("file.bin").has_value());
}

TEST(GltfUri, declares_at_least_as_many_bytes_as_it_decodes) {
  for (const char* const uri : {"data:;base64,", "data:;base64,SGVsbG8=", "data:;base64,SGVsbG8"}) {
    EXPECT_LE(decode_data_uri(uri)->size(), data_uri_bytes(uri));
  }
}

TEST(GltfUri, finds_files_beside_and_below_the_scene) {
  EXPECT_EQ(*resolve_relative_uri("/scenes/cave", "a.bin"), "/scenes/cave/a.bin");
  EXPECT_EQ(*resolve_relative_uri("/scenes/cave", "textures/a%20b.png"), "/scenes/cave/textures/a b.png");
  EXPECT_EQ(*resolve_relative_uri("/scenes/cave", "x/../a.bin"), "/scenes/cave/a.bin");
  EXPECT_EQ(*resolve_relative_uri("/scenes/cave", "100%.png"), "/scenes/cave/100%.png");
  EXPECT_EQ(*resolve_relative_uri("/scenes/cave", "..a/b"), "/scenes/cave/..a/b");
}

TEST(GltfUri, never_leaves_the_folder_of_the_scene) {
  for (const char* const uri :
       {"", "/etc/passwd", "../secret", "a/../../secret", "%2e%2e/secret", "..%2fsecret", "%2Fetc/passwd",
        "file:///etc/passwd", "http://example.com/a.bin", "c:/a.bin", ":", "a%00.bin", "..", "a/.."}) {
    const Result<std::filesystem::path> path = resolve_relative_uri("/scenes/cave", uri);
    if (path) {
      EXPECT_EQ(path->lexically_normal().string().rfind("/scenes/cave", 0), 0u) << uri;
      EXPECT_STREQ(uri, "a/..");  // The folder itself, which is not a regular file.
    } else {
      EXPECT_NE(path.error().message().find("beside the scene"), std::string::npos) << uri;
    }
  }
}

}  // namespace
}  // namespace cyclorama::scene
