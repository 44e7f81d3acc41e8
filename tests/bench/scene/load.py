# SPDX-License-Identifier: Apache-2.0
"""Loads each scene with cyclorama-render and prints seconds and memory: load.py BUILD_FOLDER [--quick].

Generated grottoes are always measured, real scenes where their data are there.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import generated  # noqa: E402

REAL = ("scenes/grotto_thousand_buddhas.glb", "scenes/cave_scan_draco.glb", "scenes/hotel_room.glb",
        "scenes/webxr_cave/cave.gltf",
        "relics/buddha_head_1m.ply", "relics/buddha_head_100k.glb", "relics/Hermes.glb", "relics/egyptian_cat.glb")


def main(build, *options):
    sizes = [1000000] if "--quick" in options else [1000000, 6000000]
    scenes = {f"grotto-{n}": generated.scene("grotto", n, f"{build}/bin") for n in sizes}
    data = pathlib.Path(os.environ.get("CYCLORAMA_SHARED", "../shared")) / "data"
    scenes |= {pathlib.Path(name).stem: data / name for name in REAL if (data / name).is_file()}
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in scenes.items():
            file = pathlib.Path(folder) / "load.json"
            subprocess.run([f"{build}/bin/cyclorama-render", "load", scene, "--json", file], check=True,
                           stdout=sys.stderr)
            rows[name] = json.loads(file.read_text())
    print(f"{'scene':<28}{'stored':>10}{'seen':>10}{'load s':>9}{'BVH s':>8}{'B/triangle':>12}")
    for name, row in rows.items():
        print(f"{name:<28}{row['triangles']:>10}{row['triangles_seen']:>10}{row['load_s']:>9.2f}{row['bvh_s']:>8.2f}"
              f"{row['bytes_per_triangle']:>12.1f}")
    kept = ("triangles", "seconds", "bytes_per_triangle")
    print(json.dumps({"benchmark": "scene-load",
                      **{name: {key: row[key] for key in kept} for name, row in rows.items()}}))


if __name__ == "__main__":
    main(*sys.argv[1:])
