#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails on a source file without its licence line, of more than 600 lines, or with a TODO that names no issue; prints the median.

Run: check_files.py SOURCE_ROOT
"""
import pathlib
import re
import statistics
import sys

FOLDERS = ["common", "drivers", "renderfarm", "appliance", "kiosk", "tests", "scripts"]
CODE = {".h", ".cpp", ".py", ".js", ".proto"}
LONGEST = 600
TODO = re.compile(r"\b(TODO|FIXME|XXX)\b(?!\(#\d+\))")


def main(root):
    root = pathlib.Path(root)
    bad, lengths = [], []
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in CODE or file.name == pathlib.Path(__file__).name:
                continue
            here = file.relative_to(root).as_posix()
            lines = file.read_text(encoding="utf-8").splitlines()
            lengths.append(len(lines))
            if len(lines) > LONGEST:
                bad.append(f"{here}: {len(lines)} lines, at most {LONGEST}")
            if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:2]):
                bad.append(f"{here}:1: no SPDX licence line")
            bad += [f"{here}:{n}: TODO without its issue" for n, line in enumerate(lines, 1) if TODO.search(line)]
    print("\n".join(bad) or f"files: ok, {len(lengths)} files, median {statistics.median(lengths):.0f} lines")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
