#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures: ./bench.sh --list, ./bench.sh NAME [--quick]. Prints a table for people, then one line that is a JSON object.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
case "${1:-}" in
  --list) find tests/bench -maxdepth 1 -name '*.bench' -printf '%f\n' | sed 's/\.bench$//' | sort | while read -r name; do
            printf '%-20s %s\n' "$name" "$(sed -n '3s/^# //p' "tests/bench/$name.bench")"; done ;;
  ""|-h|--help) sed -n '3s/^# //p' "$0" ;;
  *) bench=tests/bench/$1.bench
     [ -f "$bench" ] || { echo "bench.sh: no benchmark '$1'; see --list" >&2; exit 2; }
     shift; exec "$bench" "$@" ;;
esac
