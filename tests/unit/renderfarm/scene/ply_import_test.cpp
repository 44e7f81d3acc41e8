// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "renderfarm/scene/model.h"
#include "tests/doubles/shared_data.h"

namespace cyclorama {
namespace {

TEST(PlyImport, reads_a_million_triangles_of_a_scan_with_colours) {
  CYCLORAMA_SHARED_DATA(file, "relics/buddha_head_1m.ply");
  const Result<Model> model = import_ply(file, ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->meshes.size(), 1u);
  EXPECT_EQ(model->meshes[0].triangles.size(), 1'050'000u);
  EXPECT_EQ(model->meshes[0].colours.size(), model->meshes[0].positions.size());
}

}  // namespace
}  // namespace cyclorama
