// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/doctor_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace cyclorama::operations {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

TEST(UsualWatches, depend_on_the_role_of_this_computer) {
  const std::filesystem::path root = std::filesystem::path(testing::TempDir()) / "usual_watches";
  std::filesystem::remove_all(root);
  std::filesystem::create_directories(root / "usr/bin");
  std::filesystem::create_directories(root / "run/cyclorama-farm");
  EXPECT_THAT(usual_watches(root), SizeIs(3));
  std::ofstream(root / "usr/bin/cyclorama-node").flush();
  EXPECT_THAT(usual_watches(root), IsEmpty());
  std::ofstream(root / "run/cyclorama-farm/inspect.sock").flush();
  EXPECT_THAT(usual_watches(root), ElementsAre("coordinator=unix:/run/cyclorama-farm/inspect.sock"));
  std::ofstream(root / "usr/bin/cyclorama-tour").flush();
  EXPECT_THAT(usual_watches(root), SizeIs(3));
  std::filesystem::remove_all(root);
}

}  // namespace
}  // namespace cyclorama::operations
