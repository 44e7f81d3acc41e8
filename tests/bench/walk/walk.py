# SPDX-License-Identifier: Apache-2.0
"""Computes the light of the scenes that have none yet, and walks through them: see [walk] in benchmarks.toml."""
import argparse
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import scene_paths  # pylint: disable=wrong-import-position


def argument_of(build, name, scene, rays):
    """Returns NAME=SCENE,LIGHT for cyclorama-bench-walk; the light stays in build/lights."""
    light = pathlib.Path("build/lights") / f"{name}-{scene.name}-{rays}.store"
    if not light.exists():
        light.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([f"{build}/bin/cyclorama-render", "light", scene, "--rays", str(rays), "--max-parts", "1",
                        "--out", light], check=True, stdout=sys.stderr)
    return f"{name}={scene},{light}"


def main():
    parser = argparse.ArgumentParser()
    for name in ("build", "json", "shared"):
        parser.add_argument(name)
    for name in ("--scenes", "--fps", "--latency-ms"):
        parser.add_argument(name, type=str.split, required=True)
    parser.add_argument("--walks", type=str.split, default=["0", "1", "2"])
    parser.add_argument("--rays", type=int, required=True)
    parser.add_argument("--grotto", required=True)
    parser.add_argument("--hall", required=True)
    known, passed = parser.parse_known_args()
    found = scene_paths.paths(known.scenes, known.grotto, known.hall, known.shared)
    scenes = [argument_of(known.build, name, path, known.rays) for name, path in found.items()]
    return subprocess.run([f"{known.build}/tests/cyclorama-bench-walk", *scenes, "--fps", *known.fps, "--latency-ms",
                           *known.latency_ms, "--walks", *known.walks, "--json", known.json, *passed],
                          check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
