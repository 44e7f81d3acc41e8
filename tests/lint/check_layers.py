#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a second-level folder includes one that its row does not name, or if folders include each other in a circle.

The rows are below; docs/architecture.md draws them. Run: check_layers.py SOURCE_ROOT
"""
import pathlib
import re
import sys

# FOLDER: the other folders that its files may include. Folders of tests may include all of the product, too.
ROWS = """
common/base:
common/board:
common/config: common/base
common/edid: common/base
common/geometry: common/base
common/http: common/base
common/image: common/base
common/json: common/base
common/language: common/base
common/network: common/base common/config
common/opening: common/base common/config
common/process: common/base
common/reach: common/base common/json
common/room: common/base common/config common/geometry
common/update: common/base
common/wand: common/base common/config common/geometry
common/wire: common/base common/geometry common/image

drivers/camera: common/base common/config common/image
drivers/devices: common/base drivers/camera drivers/simulated drivers/turntable
drivers/input: common/base
drivers/output: common/base common/edid common/image common/language common/opening common/process common/room common/wire
drivers/simulated: common/base common/config common/geometry common/image common/process common/room common/wand
    common/wire drivers/camera drivers/output drivers/turntable
drivers/turntable: common/base

renderfarm/balance: common/base common/image
renderfarm/client: common/base common/geometry common/wire
renderfarm/coordinator: common/base common/config common/image common/process common/update common/wire
    renderfarm/balance renderfarm/governor renderfarm/scene_distribution renderfarm/trust renderfarm/watch
renderfarm/denoise: common/base common/geometry common/image renderfarm/render renderfarm/scene
renderfarm/generator: common/base common/process
renderfarm/governor: common/base common/config renderfarm/render
renderfarm/light: common/base renderfarm/scene
renderfarm/light_baking: common/base common/image renderfarm/light renderfarm/quality renderfarm/render renderfarm/scene
renderfarm/node: common/base common/config common/image common/process common/wire renderfarm/balance
    renderfarm/denoise renderfarm/governor renderfarm/light renderfarm/light_baking renderfarm/render renderfarm/scene
    renderfarm/scene_distribution
renderfarm/quality: common/base common/image
renderfarm/render: common/base common/geometry common/image renderfarm/light renderfarm/scene
renderfarm/scene: common/base common/config common/geometry common/image
renderfarm/scene_distribution: common/base common/wire
renderfarm/tools: common/base common/geometry common/image common/process common/wire renderfarm/balance
    renderfarm/client renderfarm/denoise renderfarm/governor renderfarm/light renderfarm/light_baking renderfarm/quality
    renderfarm/render renderfarm/scene renderfarm/trust renderfarm/walkable
renderfarm/trust: common/base common/config common/wire
renderfarm/walkable: common/base common/image renderfarm/render renderfarm/scene
renderfarm/watch: common/base common/config common/http common/image common/process common/wire

appliance/calibration: appliance/interchange appliance/warp common/base common/geometry common/image common/json
    common/room
appliance/calibrator: appliance/calibration appliance/healing appliance/scan common/base common/config common/image
    common/process common/wire drivers/camera drivers/devices drivers/simulated drivers/turntable
appliance/camera_calibration: appliance/calibration appliance/solve appliance/structured_light appliance/tags
    common/base common/board common/geometry common/image common/process drivers/devices
appliance/display: appliance/calibration appliance/interchange appliance/warp common/base common/config
    common/geometry common/image common/language common/opening common/process common/reach common/room common/wire
    drivers/output
appliance/hand: appliance/tracker common/base common/language common/process common/wire drivers/input
appliance/healing: appliance/calibration appliance/scan appliance/solve appliance/structured_light common/base
    common/image common/json common/room common/wire drivers/camera drivers/devices drivers/simulated
appliance/interchange: appliance/warp common/base common/geometry common/image common/process common/room
appliance/photometry: appliance/calibration appliance/solve appliance/structured_light appliance/warp common/base
    common/image common/json
appliance/scan: appliance/calibration appliance/photometry appliance/solve appliance/structured_light appliance/warp
    common/base common/image common/json common/room common/wire drivers/camera drivers/simulated drivers/turntable
appliance/solve: appliance/calibration common/base common/geometry
appliance/structured_light: common/base common/image
appliance/tags: appliance/calibration common/base common/image common/room
appliance/tracker: appliance/calibration appliance/tags common/base common/config common/geometry common/image
    common/process common/room common/wand common/wire drivers/camera drivers/devices
appliance/warp: common/base common/geometry common/image common/room

kiosk/care: common/base common/config common/json common/language common/opening
kiosk/network: common/base common/network common/process
kiosk/operator: common/base common/board common/config common/edid common/http common/image common/language
    common/network common/opening common/process common/reach common/room common/wand common/wire kiosk/care
    kiosk/network kiosk/provision kiosk/setup kiosk/tour kiosk/update
kiosk/provision: common/base common/config common/edid common/image common/network common/opening common/process
    common/room common/wand common/wire kiosk/care kiosk/tour kiosk/update
kiosk/renewal: common/base common/opening common/process common/wire kiosk/tour renderfarm/client
kiosk/setup: common/base common/config common/network common/room
kiosk/tour: common/base common/config common/geometry common/image common/json common/language common/process
    common/wire renderfarm/client
kiosk/update: common/base common/config common/opening common/process common/update common/wire kiosk/tour
    renderfarm/client

tests/bench: tests/data_sets tests/doubles tests/support
tests/compile_fail:
tests/data_sets:
tests/doubles:
tests/fuzz: tests/data_sets tests/doubles tests/support tests/unit
tests/scenario: tests/data_sets tests/doubles tests/support
tests/support: tests/data_sets tests/doubles
tests/tools: tests/data_sets tests/doubles tests/support
tests/unit: tests/bench tests/data_sets tests/doubles tests/support
"""
PRODUCT = ("common", "drivers", "renderfarm", "appliance", "kiosk")
# The truth of a simulated museum. Who calibrates may meet neither these headers, also by way of others, nor the file's
# name; the appliance and the kiosk hold all that a museum runs.
TRUTH_HEADERS = {f"drivers/simulated/museum/{name}.h" for name in ("truth", "true_museum", "presets", "flaws", "as_sold", "simulated_show")}
TRUTH_FILE = re.compile(r"truth\.(toml|json)")
TRUTH_CALL = re.compile(r"(?:\.|->)truth\(\)")  # Of a simulated museum, which devices for it hold.
BLIND = ("appliance", "kiosk")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def second_level(path):
    return "/".join(path.split("/")[:2]) if path.count("/") > 1 else None


def read_rows(text):
    """{folder: the folders that it may include}"""
    rows = {}
    for row in re.sub(r"\n +", " ", text).splitlines():
        folder, _, others = row.partition(":")
        if folder:
            rows[folder] = set(others.split())
    return rows


def circle(graph):
    """One circle of {node: nodes}, as the nodes on it with the first one repeated, or nothing."""
    done = set()

    def search(node, way):
        if node in way:
            return way[way.index(node):] + [node]
        if node in done:
            return []
        done.add(node)
        for other in sorted(graph.get(node, ())):
            if found := search(other, way + [node]):
                return found
        return []

    for node in sorted(graph):
        if found := search(node, []):
            return found
    return []


def includes(root, path):
    file = root / path
    if not file.is_file():
        return []
    lines = file.read_text(encoding="utf-8").splitlines()
    return [(n, m[1]) for n, line in enumerate(lines, 1) if (m := INCLUDE.match(line))]


def way_to_truth(root, path, known):
    """The headers from `path` to one that tells the truth, or nothing."""
    if path in TRUTH_HEADERS:
        return [path]
    if path not in known:
        known[path] = []
        for _, header in includes(root, path):
            if way := way_to_truth(root, header, known):
                known[path] = [path] + way
                break
    return known[path]


def told_truths(root):
    """Places in the appliance and the kiosk that could learn a simulated museum's truth."""
    bad, known = [], {}
    for top in BLIND:
        for f in sorted((root / top).rglob("*")):
            if f.suffix not in (".h", ".cpp", ".py", ".js", ".html", ".txt", ".toml") or not f.is_file():
                continue
            here = f.relative_to(root).as_posix()
            for n, header in includes(root, here):
                if way := way_to_truth(root, header, known):
                    bad.append(f"{here}:{n}: {top}/ may not know a simulated museum's truth: {' -> '.join(way)}")
            for n, line in enumerate(f.read_text(encoding="utf-8").splitlines(), 1):
                if TRUTH_FILE.search(line):
                    bad.append(f"{here}:{n}: {top}/ may not name the file of a simulated museum's truth")
                if TRUTH_CALL.search(line):
                    bad.append(f"{here}:{n}: {top}/ may not ask a simulated museum for its truth")
    return bad


def broken_rows(root, rows):
    """Includes that no row allows, folders that have no row, and circles."""
    bad, graph, unlisted = [], {}, {}
    for top in sorted({folder.split("/")[0] for folder in rows}):
        for f in sorted((root / top).rglob("*")):
            if f.suffix not in (".h", ".cpp"):
                continue
            here = f.relative_to(root).as_posix()
            own = second_level(here)
            if own not in rows:
                unlisted.setdefault(own or top, here)
                continue
            for n, header in includes(root, here):
                if "/" not in header:
                    continue
                other = second_level(header)
                if other == own:
                    continue
                graph.setdefault(own, set()).add(other or header)
                is_test = own.startswith("tests/") and header.split("/")[0] in PRODUCT
                if not is_test and other not in rows[own]:
                    bad.append(f"{here}:{n}: {own}/ may not include {header}")
    for folder, file in unlisted.items():
        bad.append(f"{file}: {folder}/ has no row in tests/lint/check_layers.py; add one or move the file")
    for graph, of in ((rows, "the rows of tests/lint/check_layers.py"), (graph, "the includes")):
        if way := circle(graph):
            bad.append(f"a circle in {of}: {' -> '.join(way)}")
    return bad


def main(root):
    root = pathlib.Path(root)
    bad = told_truths(root) + broken_rows(root, read_rows(ROWS))
    print("\n".join(bad) or "layers: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
