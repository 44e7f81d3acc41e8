# SPDX-License-Identifier: Apache-2.0
"""Measures a picture of a grotto with noise (1 sample per pixel) and one without by a command of cyclorama-bench-render.

Run: noisy_and_smooth.py BENCHMARK BUILD_FOLDER SCENE SIZE COMMAND...; COMMAND gets --json FILE and the picture.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

PICTURES = {"noisy": ["--samples", "1"], "smooth": ["--samples", "64", "--denoise"]}


def main(benchmark, build, scene, size, *command):
    render = f"{build}/bin/cyclorama-render"
    figures = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for picture, options in PICTURES.items():
            subprocess.run([render, "picture", scene, "--size", size, "--bounces", "1", *options, "--out", folder / f"{picture}.png"],
                           check=True, stdout=sys.stderr)
        for picture in PICTURES:
            print(picture, flush=True)
            subprocess.run([f"{build}/tests/cyclorama-bench-render", *command, "--json", folder / f"{picture}.json", folder / f"{picture}.png"], check=True)
            figures[picture] = json.loads((folder / f"{picture}.json").read_text())
    print(json.dumps({"benchmark": benchmark, **figures}))


if __name__ == "__main__":
    main(*sys.argv[1:])
