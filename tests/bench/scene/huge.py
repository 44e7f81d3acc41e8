#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene of very many triangles: seconds and memory to load it, and rays per cpu-second. huge.py BUILD [--millions N]

It is a row of generated grottoes of 20 million triangles each, which are stored each for itself; --copies shows each
more often, which takes no memory for triangles.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import generated  # noqa: E402

GROTTO_M = 40  # From one to the next.


def package(folder, grotto, count, copies):
    """Writes a scene with COUNT grottoes, each shown COPIES times."""
    walls = max(grotto.glob("*.ply"), key=lambda file: file.stat().st_size)
    text = 'title = "A row of grottoes"\n[start]\neye_m = [0, 1.6, 0]\n'
    for i in range(count):
        text += f'[[geometry]]\nfile = "walls{i}.ply"\n'
        (folder / f"walls{i}.ply").hardlink_to(walls)
        for copy in range(copies):
            text += f"[[geometry.instance]]\nposition_m = [{GROTTO_M * i}, 0, {GROTTO_M * copy}]\n"
    (folder / "scene.toml").write_text(text, encoding="utf-8")


def run(build, *arguments):
    done = subprocess.run([build / "bin/cyclorama-render", *map(str, arguments)], check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--millions", type=int, default=100)
    options.add_argument("--copies", type=int, default=1)
    options.add_argument("--memory", default="compact", choices=("fast", "medium", "compact"))
    options.add_argument("--quick", action="store_true", help="2 million triangles")
    said = options.parse_args()
    of_one = 1_000_000 if said.quick else 20_000_000
    count = 2 if said.quick else max(1, said.millions // 20)
    grotto = generated.scene("grotto", of_one, f"{said.build}/bin").resolve()
    with tempfile.TemporaryDirectory(dir=grotto.parent) as name:
        folder = pathlib.Path(name)
        package(folder, grotto, count, said.copies)
        loaded_file, cost_file = folder / "loaded.json", folder / "cost.json"
        run(said.build, "load", folder, "--memory", said.memory, "--json", loaded_file)
        run(said.build, "picture", folder, "--memory", said.memory, "--size", "480x180", "--samples", 1, "--out",
            folder / "picture.png", "--json", cost_file)
        loaded = json.loads(loaded_file.read_text(encoding="utf-8"))
        cost = json.loads(cost_file.read_text(encoding="utf-8"))
    rate = cost["rays"] / cost["cpu_s"] / 1e6
    gib = loaded["peak_rss_bytes"] / 2**30
    print(f"{loaded['triangles'] / 1e6:.1f} million triangles, {loaded['triangles_seen'] / 1e6:.1f} seen: loaded in "
          f"{loaded['load_s']:.1f} s, BVH in {loaded['bvh_s']:.1f} s, {gib:.2f} GiB at most, "
          f"{loaded['resident_bytes_per_triangle']:.1f} bytes per triangle, {rate:.2f} million rays per cpu-second")
    print(json.dumps({"benchmark": "scene-huge", "triangles": loaded["triangles"], "seen": loaded["triangles_seen"],
                      "load_s": round(loaded["load_s"], 1), "bvh_s": round(loaded["bvh_s"], 1), "gib": round(gib, 2),
                      "mrays_per_cpu_s": round(rate, 3)}))


if __name__ == "__main__":
    main()
