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
    "common/config": ["common/base", "common/config"],
    "common/opening": ["common/base", "common/config", "common/opening"],
    "common/process": ["common/base", "common/process"],
    "common/room": ["common/base", "common/config", "common/geometry", "common/room"],
    "common/wire": ["common/base", "common/geometry", "common/image", "common/wire"],
    "common": ["common"],
    "drivers/simulated_room": ["common", "drivers"],
    "drivers": ["common", "drivers"],
    "renderfarm": ["common", "renderfarm"],
    "appliance": ["common", "drivers", "appliance"],
    "kiosk": ["common", "renderfarm/client", "kiosk"],
    "tests": ["common", "drivers", "renderfarm", "appliance", "kiosk", "tests"],
}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')


def under(path, folder):
    return path == folder or path.startswith(folder + "/")


def main(root):
    root = pathlib.Path(root)
    bad = []
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
