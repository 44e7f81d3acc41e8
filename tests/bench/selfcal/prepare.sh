# SPDX-License-Identifier: Apache-2.0
# Sourced by the selfcal benchmarks: builds, and has the grotto rendered once. Sets $content.
scripts/install-packages test
cmake --preset release >/dev/null
cmake --build --preset release --target selfcal_bench cyclorama-grotto cyclorama-render >&2
content=build/release/selfcal/grotto.png
if [ ! -f "$content" ]; then
  mkdir -p build/release/selfcal
  build/release/bin/cyclorama-grotto --triangles 400000 --force --out build/release/selfcal/scene >&2
  build/release/bin/cyclorama-render picture build/release/selfcal/scene --size 6144x704 --samples 8 --denoise --out "$content.part.png" >&2
  mv "$content.part.png" "$content"
fi
