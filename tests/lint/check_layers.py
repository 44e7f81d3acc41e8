#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a file includes a folder that its own folder may not include.

The rule is the table below; docs/architecture.md draws it. Run: check_layers.py SOURCE_ROOT
"""
import pathlib
import re
import sys

MAY_INCLUDE = {
    "common/base": ["common/base"],
    "common/geometry": ["common/base", "common/geometry"],
    "common/image": ["common/base", "common/image"],
    "common/http": ["common/base", "common/http"],
    "common/board": ["common/base", "common/board", "common/geometry"],
    "common/config": ["common/base", "common/config"],
    "common/opening": ["common/base", "common/config", "common/opening"],
    "common/process": ["common/base", "common/process"],
    "common/room": ["common/base", "common/config", "common/geometry", "common/room"],
    "common/update": ["common/base", "common/update"],
    "common/wand": ["common/base", "common/config", "common/geometry", "common/wand"],
    "common/wire": ["common/base", "common/geometry", "common/image", "common/wire"],
    "common": ["common"],
    "drivers/simulated": ["common", "drivers"],
    "drivers": ["common", "drivers"],
    "renderfarm": ["common", "renderfarm"],
    "appliance": ["common", "drivers", "appliance"],
    "kiosk": ["common", "renderfarm/client", "kiosk"],
    "tests": ["common", "drivers", "renderfarm", "appliance", "kiosk", "tests"],
}
# The truth of a simulated museum. Who calibrates may meet neither these headers, also by way of others, nor the file's
# name; the appliance and the kiosk hold all that a museum runs.
TRUTH_HEADERS = {f"drivers/simulated/museum/{name}.h" for name in ("truth", "true_museum", "presets", "flaws", "simulated_show")}
TRUTH_FILE = re.compile(r"truth\.(toml|json)")
TRUTH_CALL = re.compile(r"(?:\.|->)truth\(\)")  # Of a simulated museum, which devices for it hold.
BLIND = ("appliance", "kiosk")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def under(path, folder):
    return path == folder or path.startswith(folder + "/")


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


def main(root):
    root = pathlib.Path(root)
    bad = told_truths(root)
    for top in sorted({k.split("/")[0] for k in MAY_INCLUDE}):
        for f in sorted((root / top).rglob("*")):
            if f.suffix not in (".h", ".cpp"):
                continue
            here = f.relative_to(root).as_posix()
            rule = max((k for k in MAY_INCLUDE if under(here, k)), key=len)
            for n, line in enumerate(f.read_text(encoding="utf-8").splitlines(), 1):
                m = INCLUDE.match(line)
                if m and not any(under(m[1], a) for a in MAY_INCLUDE[rule]):
                    bad.append(f"{here}:{n}: {rule}/ may not include {m[1]}")
    print("\n".join(bad) or "layers: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
