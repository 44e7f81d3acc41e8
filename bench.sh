#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures: ./bench.sh --list, ./bench.sh NAME [--quick]. Prints a table for people, then one line that is a JSON object.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
command -v python3 >/dev/null || { echo "bench.sh: needs python3; scripts/install-packages build installs it" >&2; exit 1; }
exec python3 tests/bench/run.py "$@"
