# SPDX-License-Identifier: Apache-2.0
"""Compares stored light with path tracing in several scenes: see [light-equal-error] in benchmarks.toml."""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import scene_paths  # pylint: disable=wrong-import-position


def main():
    parser = argparse.ArgumentParser()
    for name in ("build", "json", "shared", "grotto", "hall"):
        parser.add_argument(name)
    parser.add_argument("--scenes", type=str.split, required=True)
    known, passed = parser.parse_known_args()
    figures = {}
    for name, path in scene_paths.paths(known.scenes, known.grotto, known.hall, known.shared).items():
        print(f"{name}:", flush=True)
        with tempfile.NamedTemporaryFile(suffix=".json") as result:
            status = subprocess.run([f"{known.build}/tests/cyclorama-bench-render", "light", path, "--json",
                                     result.name, *passed], check=False).returncode
            if status != 0:
                return status
            figures[name] = json.loads(pathlib.Path(result.name).read_text(encoding="utf-8"))
    pathlib.Path(known.json).write_text(json.dumps(figures), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
