#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs one visit, end to end, on this machine: a farm renders a grotto, and a museum shows it on a curved wall.
#
#   ./demo.sh                                    serves a page; Ctrl-C ends everything
#   ./demo.sh --headless --seconds 30 --out DIR  writes DIR/*.png and DIR/summary.json; fails if any part did not work
#
#   --scene FILE      a scene package, .glb, .gltf, .ply or .obj; default: a generated grotto
#   --triangles N     size of the generated grotto (1000000)
#   --seed S          seed of the generated grotto (1)
#   --nodes N         number of render nodes (2)
#   --installation F  the room: wall, sweet spot and projectors (demo/installation.toml; demo/ has rooms of every kind)
#   --size WxH        the picture on the wall, in pixels (768x288; in another room 768 wide with square pixels)
#   --budget-ms N     time per frame: the farm chooses the quality that fits, and refines pictures at rest (150)
#   --samples N       fixed number of rays per pixel instead of a budget
#   --camera SPEC     the tag camera: simulated (default), file:PHOTO, file:VIDEO
#   --port N          the page's port (8080)
set -euo pipefail
called_from=$PWD
cd "$(dirname "$(readlink -f "$0")")"
started=$(date +%s.%N)

headless=0 seconds=30 out="" scene="" triangles=1000000 seed=1 nodes=2 installation="" size="" budget_ms="" samples="" camera="" page_port=8080
usage() { sed -n '3,17s/^# \{0,1\}//p' "$0"; }
here() { [[ $1 = /* ]] && echo "$1" || echo "$called_from/$1"; }  # Resolves a path against the caller's folder.
need() { [ $# -ge 2 ] || { echo "demo.sh: $1 needs a value; see --help" >&2; exit 2; }; }
while [ $# -gt 0 ]; do
  case "$1" in
    --headless) headless=1; shift ;;
    --seconds) need "$@"; seconds=$2; shift 2 ;;
    --out) need "$@"; out=$(here "$2"); shift 2 ;;
    --scene) need "$@"; scene=$(here "$2"); shift 2 ;;
    --triangles) need "$@"; triangles=$2; shift 2 ;;
    --seed) need "$@"; seed=$2; shift 2 ;;
    --nodes) need "$@"; nodes=$2; shift 2 ;;
    --installation) need "$@"; installation=$(here "$2"); shift 2 ;;
    --size) need "$@"; size=$2; shift 2 ;;
    --budget-ms) need "$@"; budget_ms=$2; shift 2 ;;
    --samples) need "$@"; samples=$2; shift 2 ;;
    --camera) need "$@"; camera=$2; [[ $camera != *:* ]] || camera=${camera%%:*}:$(here "${camera#*:}"); shift 2 ;;
    --port) need "$@"; page_port=$2; shift 2 ;;
    -h|--help) usage; exit 0 ;;
    *) echo "demo.sh: '$1' is not an option; see --help" >&2; exit 2 ;;
  esac
done
whole() {  # OPTION VALUE MIN MAX
  [[ $2 =~ ^(0|[1-9][0-9]{0,8})$ ]] && [ "$2" -ge "$3" ] && [ "$2" -le "$4" ] && return
  echo "demo.sh: $1 must be a whole number from $3 to $4, not '$2'" >&2; exit 2
}
whole --seconds "$seconds" 1 86400
whole --triangles "$triangles" 10000 60000000
whole --seed "$seed" 0 999999999
whole --nodes "$nodes" 1 64
[ -z "$budget_ms" ] || [ -z "$samples" ] || { echo "demo.sh: --samples and --budget-ms exclude each other" >&2; exit 2; }
picture=(--budget-ms "${budget_ms:-150}")
[ -z "$samples" ] || picture=(--samples "$samples")
whole "${picture[@]}" 1 4096
whole --port "$page_port" 1 65535
[ -z "$installation" ] || [ -e "$installation" ] || { echo "demo.sh: no such installation: $installation" >&2; exit 2; }
[ -n "$size" ] || { [ -n "$installation" ] && size=768x0 || size=768x288; }
[ -n "$installation" ] || installation=demo/installation.toml
[[ $size =~ ^[0-9]+x[0-9]+$ ]] || { echo "demo.sh: --size must be WIDTHxHEIGHT, not '$size'" >&2; exit 2; }
[ "$headless" = 0 ] || [ -n "$out" ] || { echo "demo.sh: --headless needs --out DIR" >&2; exit 2; }
[ -z "$scene" ] || [ -e "$scene" ] || { echo "demo.sh: no such scene: $scene" >&2; exit 2; }

scripts/install-packages build
build=${CYCLORAMA_BUILD:-build/release}
if [ -z "${CYCLORAMA_BUILD:-}" ]; then
  tests=ON; dpkg-query -W -f='${db:Status-Status}' libgmock-dev 2>/dev/null | grep -q '^installed' || tests=OFF
  mkdir -p build
  programs=demo; [ "$headless" = 0 ] || programs=demo-headless
  ( flock 9; cmake --preset release -DCYCLORAMA_TESTS=$tests >/dev/null; cmake --build --preset release --target $programs ) 9>build/demo.lock
fi
program() { echo "$build/bin/$1"; }

run_dir=$(mktemp -d "${TMPDIR:-/tmp}/cyclorama-demo.XXXXXX")
mkdir "$run_dir/log"
declare -A pids
recorder=""
stop_all() {
  trap - EXIT
  trap '' INT TERM
  for name in "${!pids[@]}"; do kill -TERM "${pids[$name]}" 2>/dev/null || true; done
  [ -z "$recorder" ] || kill -TERM "$recorder" 2>/dev/null || true
  for name in "${!pids[@]}"; do
    for _ in $(seq 50); do kill -0 "${pids[$name]}" 2>/dev/null || break; sleep 0.1; done
    if kill -KILL "${pids[$name]}" 2>/dev/null; then echo "demo.sh: $name did not stop within 5 s" >&2; failed=1; fi
  done
}
failed=0
finish() {
  local code=$?
  [ "$BASHPID" = $$ ] || exit $code  # A child that was stopped before its exec.
  stop_all
  rm -rf "$run_dir"
  [ $code -ne 0 ] || code=$failed
  exit $code
}
trap finish EXIT
trap 'exit $((headless * 130))' INT TERM  # An interrupted recording has failed; an interrupted visit just ends.

start() {  # NAME PROGRAM ARGUMENTS...
  local name=$1 path; path=$(program "$2"); shift 2
  [ -x "$path" ] || { echo "demo.sh: $name is not built" >&2; exit 1; }
  "$path" "$@" >"$run_dir/log/$name.log" 2>&1 &
  pids[$name]=$!
}
check_alive() {
  for name in "${!pids[@]}"; do
    kill -0 "${pids[$name]}" 2>/dev/null && continue
    echo "demo.sh: $name ended; the end of its log:" >&2; tail -n 12 "$run_dir/log/$name.log" >&2
    return 1
  done
  # All nodes are on this machine: a scene that one cannot load, none can.
  if grep -m1 "cannot load scene" "$run_dir/log/coordinator.log" >&2; then return 1; fi
}

own_scene=$scene
if [ -z "$scene" ]; then
  scene=build/grottoes/$triangles-$seed
  mkdir -p build/grottoes
  ( flock 9; [ -f "$scene/scene.toml" ] || "$(program cyclorama-grotto)" --triangles "$triangles" --seed "$seed" --out "$scene"
    # Once per grotto: two minutes of one core for a million triangles, and pictures are sharp and free of noise.
    # One that is damaged, or of an earlier program, is made anew.
    "$(program cyclorama-render)" light "$scene" --if-needed --rays 64 --max-parts 1 ) 9>build/grottoes/demo.lock
fi

taken() {  # PORT COUNT: true if a process listens on one of these ports.
  grep -qE "^ *[0-9]+: [0-9A-F]+:($(seq "$1" $(($1 + $2 - 1)) | xargs printf '|%04X' | cut -c2-)) [0-9A-F:]+ 0A " /proc/net/tcp6
}
if [ "$headless" = 0 ] && taken "$page_port" 1; then
  echo "demo.sh: port $page_port is in use, perhaps by another demo; choose one with --port N" >&2; exit 1
fi
# A block of free ports, so that two demos do not collide; below the range from which the system assigns ports.
port=$((20000 + RANDOM % 12000))
while taken $port 8; do port=$((20000 + RANDOM % 12000)); done
at() { echo "[::1]:$((port + $1))"; }
watch=(--watch "tour=$(at 2)" --watch "display=$(at 3)" --watch "tracker=$(at 4)" --watch "simulated-room=$(at 5)" --watch "coordinator=$(at 6)")

start coordinator cyclorama-farm --scene "visit=$scene" --museums "$(at 0)" --nodes "$(at 1)" --inspect "$(at 6)"
for i in $(seq "$nodes"); do start "node-$i" cyclorama-node --coordinator "$(at 1)" --threads 1 --name "node-$i"; done
# The tour of the generated grotto is copied, since stops can be added to it.
[ -n "$own_scene" ] || cp -r demo/tour "$run_dir/tour"
start tour cyclorama-tour --listen "$(at 2)" --farm "$(at 0)" --tour "$run_dir/tour" --pictures "$run_dir/pictures" "${picture[@]}"
start display cyclorama-display --installation "$installation" --tour "$(at 2)" --listen "$(at 3)" --run-dir "$run_dir" --width "${size%x*}" --height "${size#*x}" --refresh-hz 20
start simulated-room cyclorama-simulated-room --installation "$installation" --run-dir "$run_dir" --listen "$(at 5)" --rate-hz 6
start tracker cyclorama-tracker --camera "${camera:-simulated}" --tour "$(at 2)" --listen "$(at 4)"
[ "$headless" = 1 ] || start operator cyclorama-operator --no-pin --listen "[::1]:$page_port" "${watch[@]}"

if [ "$headless" = 1 ]; then
  mkdir -p "$out"
  status=0
  "$(program cyclorama)" record --seconds "$seconds" --out "$out" --started "$started" "${watch[@]}" &
  recorder=$!
  # When a part has ended, the recorder would wait long for the first picture.
  while kill -0 "$recorder" 2>/dev/null; do
    check_alive || { status=1; kill -TERM "$recorder" 2>/dev/null || true; break; }
    sleep 0.5
  done
  wait "$recorder" || status=1
  mkdir -p "$out/log" && cp "$run_dir"/log/*.log "$out/log/"
  exit $status
fi
echo "The visit is on http://[::1]:$page_port/   (Ctrl-C ends it)"
while sleep 1; do check_alive || exit 1; done
