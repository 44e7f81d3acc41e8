#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds everything and runs all quick tests.
#   ./test.sh [--preset release|dev|asan|tsan] [--only LABEL] [CTEST OPTIONS]      ./test.sh --fuzz SECONDS
# --only builds and runs the tests of one label alone: unit, farm, or untrusted (what parses foreign bytes).
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
preset=release
what=() which=()
while [ $# -gt 0 ]; do
  case "$1" in
    --preset) preset=${2:?release, dev, asan or tsan}; shift 2 ;;
    --only) what=(--target "tests-${2:?a label}") which=(--label-regex "^$2\$"); shift 2 ;;
    --fuzz) exec tests/fuzz/run "${2:?seconds per target}" ;;
    -h|--help) sed -n '3,5s/^# //p' "$0"; exit 0 ;;
    *) break ;;
  esac
done
scripts/install-packages test
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" "${what[@]}"
ctest --preset "$preset" --parallel "$(nproc)" "${which[@]}" "$@"
