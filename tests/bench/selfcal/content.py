# SPDX-License-Identifier: Apache-2.0
"""Renders the content of the selfcal benchmarks' museums once: content.py BUILD_FOLDER makes its selfcal/grotto.png."""
import pathlib
import subprocess
import sys


def main(build):
    folder = pathlib.Path(build) / "selfcal"
    picture, part = folder / "grotto.png", folder / "grotto.part.png"
    if picture.is_file():
        return
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([f"{build}/bin/cyclorama-grotto", "--triangles", "400000", "--force", "--out", folder / "scene"],
                   check=True, stdout=sys.stderr)
    subprocess.run([f"{build}/bin/cyclorama-render", "picture", folder / "scene", "--size", "6144x704",
                    "--samples", "8", "--denoise", "--out", part], check=True, stdout=sys.stderr)
    part.rename(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
