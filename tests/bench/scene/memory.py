#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bytes of each triangle against rays per cpu-second, in each memory mode: memory.py BUILD [--triangles N] [--quick].

Bytes are those in memory after loading, less those of the program before it. The modes take turns on each scene, on one
thread; a rate is the turns' median, and the ratio is to the fast mode.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import generated  # noqa: E402

MODES = ("fast", "medium", "compact")
REAL = ("relics/buddha_head_1m.ply", "scenes/hotel_room.glb")


def run(build, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        figures = pathlib.Path(folder) / "figures.json"
        subprocess.run([build / "bin/cyclorama-render", *map(str, arguments), "--json", figures], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder)
        return json.loads(figures.read_text(encoding="utf-8"))


def measure(build, scene, turns):
    rows = {mode: {"rates": []} for mode in MODES}
    for mode in MODES:
        loaded = run(build, "load", scene, "--memory", mode)
        rows[mode] |= {"bytes_per_triangle": loaded["resident_bytes_per_triangle"], "peak_rss_bytes": loaded["peak_rss_bytes"]}
    for _ in range(turns):
        for mode in MODES:
            cost = run(build, "picture", scene, "--memory", mode, "--size", "640x240", "--samples", 4, "--threads", 1,
                       "--out", "picture.png")
            rows[mode]["rates"].append(cost["rays"] / cost["cpu_s"] / 1e6)
    for row in rows.values():
        row["mrays_per_cpu_s"] = statistics.median(row.pop("rates"))
    return rows


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--triangles", type=int, default=1_000_000)
    options.add_argument("--quick", action="store_true", help="a grotto of 100,000 triangles, one turn")
    said = options.parse_args()
    build = said.build.resolve()
    count = 100_000 if said.quick else said.triangles
    scenes = {f"grotto of {count}": generated.scene("grotto", count, f"{build}/bin").resolve()}
    data = pathlib.Path(os.environ.get("CYCLORAMA_SHARED", "../shared")).resolve() / "data"
    if not said.quick:
        scenes |= {pathlib.Path(name).stem: data / name for name in REAL if (data / name).is_file()}
    total = {mode: {"bytes_per_triangle": 0.0, "rays_ratio": []} for mode in MODES}
    print(f"{'scene':<24}{'mode':<10}{'B/triangle':>12}{'Mrays/cpu-s':>13}{'of fast':>9}{'peak MiB':>10}")
    for name, scene in scenes.items():
        rows = measure(build, scene, 1 if said.quick else 3)
        for mode, row in rows.items():
            ratio = row["mrays_per_cpu_s"] / rows["fast"]["mrays_per_cpu_s"]
            print(f"{name:<24}{mode:<10}{row['bytes_per_triangle']:>12.1f}{row['mrays_per_cpu_s']:>13.2f}"
                  f"{ratio:>9.2f}{row['peak_rss_bytes'] / 2**20:>10.0f}")
            total[mode]["bytes_per_triangle"] = max(total[mode]["bytes_per_triangle"], row["bytes_per_triangle"])
            total[mode]["rays_ratio"].append(ratio)
    print(json.dumps({"benchmark": "scene-memory",
                      **{mode: {"bytes_per_triangle": round(row["bytes_per_triangle"], 1),
                                "rays_ratio": round(statistics.mean(row["rays_ratio"]), 3)}
                         for mode, row in total.items()}}))


if __name__ == "__main__":
    main()
