#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything, runs all quick tests.
#   ./test.sh [--preset release|dev|asan|tsan] [CTEST OPTIONS]      ./test.sh --fuzz SECONDS
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
preset=release
case "${1:-}" in
  --preset) preset=${2:?release, dev, asan or tsan}; shift 2 ;;
  --fuzz) exec tests/fuzz/run "${2:?seconds per target}" ;;
  -h|--help) sed -n '3,4s/^# //p' "$0"; exit 0 ;;
esac
scripts/install-packages test
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" "$@"
