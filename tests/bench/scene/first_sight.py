# SPDX-License-Identifier: Apache-2.0
"""Renders the first sight of each scene and judges it: first_sight.py BUILD_FOLDER SHEET.png [--quick] [FOLDER ...]

A scene is sensible if it loads, and its picture is neither too dark, too bright nor empty. SHEET.png shows all of them,
which is how a person judges: scenes that fail have a red frame. Scenes are the files of the shared data and of the
folders given that have the suffix of a format of scenes.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import png_picture

WIDTH, HEIGHT, FRAME, ACROSS = 256, 128, 3, 5
# Bounds of the middle brightness, of the parts that are clipped to white, and of the part where something shows.
DARKEST, BRIGHTEST, MAX_CLIPPED, MIN_SHOWN = 10, 235, 0.25, 0.01
SUFFIXES = {".glb", ".gltf", ".ply", ".obj", ".las", ".laz", ".e57", ".spz"}
# Test files of a program's reader, not scenes.
LEFT_OUT = {"bad", "asset_generator", "khr_conformance_matrix.glb", "khr_conformance_matrix.gltf",
            "khr_extensible_fallback.gltf"}


def scenes_of(folders):
    for folder in folders:
        for file in sorted(folder.rglob("*")):
            is_scene = file.suffix.lower() in SUFFIXES
            if is_scene and not LEFT_OUT & set(file.relative_to(folder).parts):
                yield file


def luminance(row, x):
    return (2 * row[3 * x] + 7 * row[3 * x + 1] + row[3 * x + 2]) // 10


def fault_of(rows):
    """Returns what is wrong with a picture, or nothing."""
    light = [[luminance(row, x) for x in range(WIDTH)] for row in rows]
    levels = sorted(value for row in light for value in row)
    middle = levels[len(levels) // 2]
    # Something shows where a pixel differs from its neighbour, or, softly, from most of its row.
    usual = [sorted(row)[WIDTH // 2] for row in light]
    shown = sum(abs(row[x] - row[x - 1]) > 6 or abs(row[x] - usual[y]) > 15
                for y, row in enumerate(light) for x in range(1, WIDTH))
    if middle < DARKEST or middle > BRIGHTEST:
        return f"middle brightness {middle}"
    if sum(value >= 250 for value in levels) > MAX_CLIPPED * len(levels):
        return "burnt out"
    return "nothing to see" if shown < MIN_SHOWN * len(levels) else ""


def look(render, scene, picture, samples):
    """Renders the view of a visitor; returns the rows, or nothing, and the fault."""
    # A scene that brings its own unit and lamps needs no more than its name.
    done = subprocess.run([render, "picture", scene, "--out", picture, "--size", f"{WIDTH}x{HEIGHT}", "--azimuth-deg",
                           "120", "--samples", str(samples)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True, check=False)
    if done.returncode != 0:
        return None, (done.stderr.strip().splitlines() or ["failed"])[-1]
    rows = png_picture.read(picture)[2]
    return rows, fault_of(rows)


def framed(rows, fault):
    colour = bytes((200, 30, 30)) if fault else bytes((40, 40, 40))
    rows = rows or [bytes((90, 90, 90)) * WIDTH] * HEIGHT
    edge = [colour * (WIDTH + 2 * FRAME)] * FRAME
    return edge + [colour * FRAME + bytes(row) + colour * FRAME for row in rows] + edge


def sheet_of(tiles):
    empty = framed(None, "")
    tiles = tiles + [empty] * (-len(tiles) % ACROSS)
    return [b"".join(parts) for i in range(0, len(tiles), ACROSS) for parts in zip(*tiles[i:i + ACROSS])]


def main(build, sheet, *options):
    data = pathlib.Path(os.environ.get("CYCLORAMA_SHARED", "../shared")) / "data"
    folders = [data] + [pathlib.Path(option) for option in options if option != "--quick"]
    samples = 4 if "--quick" in options else 16
    tiles, faults, refused = [], {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes_of(folders):
            rows, fault = look(f"{build}/bin/cyclorama-render", scene, pathlib.Path(folder) / "first.png", samples)
            # What is refused with a reason is no first sight; the table says why.
            if rows is None:
                refused[scene.name] = fault
                continue
            tiles.append(framed(rows, fault))
            print(f"{len(tiles):>4}  {scene.name:<44}{fault or 'sensible'}", file=sys.stderr)
            if fault:
                faults[scene.name] = fault
    for name, why in refused.items():
        print(f"   -  {name:<44}{why[-120:]}", file=sys.stderr)
    rows = sheet_of(tiles)
    png_picture.write(pathlib.Path(sheet), len(rows[0]) // 3, rows)
    print(f"{len(tiles)} scenes, {len(tiles) - len(faults)} sensible, {len(refused)} refused; look at {sheet}")
    print(json.dumps({"benchmark": "first-sight", "scenes": len(tiles), "sensible": len(tiles) - len(faults),
                      "refused": len(refused), "faults": faults}))


if __name__ == "__main__":
    main(*sys.argv[1:])
