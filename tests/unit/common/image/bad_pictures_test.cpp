// SPDX-License-Identifier: Apache-2.0
// Every picture of the shared bad data either loads or gives one clear error.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "common/image/image_file.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama {
namespace {

struct Tally {
  int loaded = 0;
  int refused = 0;
  std::set<std::string> reasons;
};

Tally try_all(const std::filesystem::path& folder) {
  Tally tally;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename() == "LICENSE") continue;
    const auto image = read_image(entry.path(), kPhotoLimitPx);
    if (image) {
      EXPECT_GT(image->width(), 0);
      EXPECT_GT(image->height(), 0);
      ++tally.loaded;
      continue;
    }
    ++tally.refused;
    const std::string& message = image.error().message();
    EXPECT_EQ(image.error().code(), ErrorCode::kBadData) << message;
    EXPECT_NE(message.find(entry.path().string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    tally.reasons.insert(message.substr(message.find("': ") + 3));
  }
  std::printf("%s: %d loaded, %d refused:\n", folder.filename().c_str(), tally.loaded, tally.refused);
  for (const std::string& reason : tally.reasons) std::printf("  %s\n", reason.c_str());
  return tally;
}

TEST(BadPictures, png_files_of_a_fuzzer_load_or_are_refused) {
  CYCLORAMA_SHARED_DATA(folder, "bad/go_fuzz_png");
  const Tally tally = try_all(folder);
  EXPECT_GT(tally.loaded, 0);
  EXPECT_GT(tally.refused, 0);
}

TEST(BadPictures, jpeg_files_of_a_fuzzer_load_or_are_refused) {
  CYCLORAMA_SHARED_DATA(folder, "bad/go_fuzz_jpeg");
  const Tally tally = try_all(folder);
  EXPECT_GT(tally.loaded, 0);
  EXPECT_GT(tally.refused, 0);
}

TEST(BadPictures, jpeg_files_of_another_fuzzer_load_or_are_refused) {
  CYCLORAMA_SHARED_DATA(folder, "bad/afl_jpeg");
  EXPECT_GT(try_all(folder).refused, 0);
}

TEST(BadPictures, openexr_files_are_refused_by_name) {
  CYCLORAMA_SHARED_DATA(folder, "bad/openexr");
  const Tally tally = try_all(folder);
  EXPECT_EQ(tally.loaded, 0);
  for (const std::string& reason : tally.reasons)
    EXPECT_NE(reason.find("convert it to PNG or JPEG"), std::string::npos);
}

}  // namespace
}  // namespace cyclorama
