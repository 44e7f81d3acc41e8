// SPDX-License-Identifier: Apache-2.0
// The first two bytes are the number of elements, the third chooses the stride, and the rest is a stream of version 1.
#include "renderfarm/scene/gltf_meshopt_attributes.h"

#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3) return 0;
  const std::size_t count = data[0] + 256u * data[1];
  const std::size_t stride = 4 * (data[2] % 64 + std::size_t{1});
  std::vector<std::byte> stream = {std::byte{0xa1}};
  for (std::size_t i = 3; i < size; ++i) stream.push_back(static_cast<std::byte>(data[i]));
  auto bytes = cyclorama::scene::decode_meshopt_attributes_v1(stream, count, stride);
  if (!bytes) return 0;
  CHECK(bytes->size() == count * stride);
  if (stride == 4 || stride == 8) cyclorama::scene::apply_meshopt_colour_filter(stride, *bytes);
  return 0;
}
