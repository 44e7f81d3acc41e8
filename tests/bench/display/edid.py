#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads every EDID of a collection as a head does that is driven by it, and compares the modes with the collection's index.

Run: edid.py BUILD [--folder FOLDER]; FOLDER has edids.tar.xz and INDEX.tsv (name, vendor, preferred timing, conformity).
"""
import argparse
import collections
import csv
import json
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile

MAX_SENTENCE = 300  # Characters of the longest message that still counts as one clear sentence.


def read_all(program, files):
    """What the program prints of each file; a file at which it dies becomes ["crash", signal]."""
    found = {}
    left = list(files)
    while left:
        ended = subprocess.run([program, *left], stdout=subprocess.PIPE, text=True, errors="replace", check=False)
        for line in ended.stdout.splitlines():
            name, *rest = line.split("\t")
            found[name] = rest if rest and rest[0] else ["crash", str(ended.returncode)]
        if ended.returncode == 0:
            break
        left = [name for name in left if name not in found]
    return found


def size_of(text):
    """(width, height, rate) of a preferred timing, such as "(1280x1024 60.019740 Hz)"; None if there is none."""
    match = re.search(r"(\d+)x(\d+)i?[ @]+([\d.]+)", text)
    return (int(match[1]), int(match[2]), float(match[3])) if match else None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path)
    options = parser.parse_args()
    folder = options.folder or pathlib.Path(__file__).resolve().parents[4] / "shared/data/edid"
    if not (folder / "edids.tar.xz").exists():
        print(f"edid: {folder} has no edids.tar.xz: nothing to read")
        return 77
    with open(folder / "INDEX.tsv", encoding="utf-8") as index:
        listed = {row["name"]: row for row in csv.DictReader(index, delimiter="\t")}
    with tempfile.TemporaryDirectory() as scratch:
        with tarfile.open(folder / "edids.tar.xz") as archive:
            archive.extractall(scratch)
        files = sorted(map(str, pathlib.Path(scratch).rglob("*.bin")))
        found = read_all(options.build / "tests/display_edid_modes", files)
    kinds = collections.Counter(rest[0] for rest in found.values())
    compared = agreed = 0
    differ = []
    for path, rest in sorted(found.items()):
        name = pathlib.Path(path).name
        if rest[0] != "mode":
            print(f"{name}: {rest[0]}: {rest[1].replace(str(pathlib.Path(path).parent) + '/', '')}")
            continue
        wanted = size_of(listed.get(name, {}).get("preferred", ""))
        if not wanted:
            continue
        ours = size_of(rest[1])
        compared += 1
        if ours[:2] == wanted[:2] and abs(ours[2] - wanted[2]) < 0.02:
            agreed += 1
        else:
            differ.append(f"{name}: {rest[1]}, but the index says {listed[name]['preferred']}")
    print(f"{len(files)} files: {kinds['mode']} modes, {kinds['sentence']} sentences, {kinds['crash']} crashes; "
          f"{agreed} of {compared} modes are the preferred timing of the index")
    for line in differ[:40]:
        print(f"  {line}")
    unclear = sum(rest[0] == "sentence" and not 20 <= len(rest[1]) <= MAX_SENTENCE for rest in found.values())
    print(json.dumps({"benchmark": "edid", "files": len(files), "modes": kinds["mode"], "sentences": kinds["sentence"],
                      "crashes": kinds["crash"], "compared": compared, "as_preferred": agreed}))
    whole = kinds["mode"] + kinds["sentence"] == len(files)
    return 0 if whole and not kinds["crash"] and not unclear else 1


if __name__ == "__main__":
    sys.exit(main())
