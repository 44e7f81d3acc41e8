#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Seconds from a bare Debian 12 to the first picture on the wall, then those of a second start. Needs root for the bare Debian.
set -euo pipefail
root=$(mktemp -d /var/tmp/cyclorama-bare.XXXXXX)
# in-debian reports a mount that is left below; then nothing is deleted.
trap 'grep -qF " $root/" /proc/self/mounts || rm -rf --one-file-system "$root"' EXIT
measure() {  # Prints the seconds from the start of ./demo.sh to the first picture on the wall.
  KEEP=$root scripts/in-debian bookworm bash -c './demo.sh --headless --seconds 5 --out out >&2 &&
    python3 -c "import json; print(json.load(open(\"out/summary.json\"))[\"first_picture_s\"])"'
}
bare=$(measure | tail -n 1)
again=$(measure | tail -n 1)
printf 'from bare Debian 12: %.1f s\na second start:      %.1f s\n' "$bare" "$again"
echo "{\"benchmark\": \"first-picture\", \"bare_s\": $bare, \"again_s\": $again}"
