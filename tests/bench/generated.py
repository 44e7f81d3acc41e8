# SPDX-License-Identifier: Apache-2.0
"""Generated scenes for the benchmarks. They stay in build/, so that each is made once."""
import pathlib
import subprocess
import sys

FOLDERS = {"grotto": "grottoes", "interior": "interiors", "relic": "relics"}


def scene(kind, triangles, programs="build/release/bin"):
    """Returns the folder of a generated scene (seed 1) and makes it first if it is not there."""
    folder = pathlib.Path("build") / FOLDERS[kind] / f"{triangles}-1"
    if not (folder / "scene.toml").is_file():
        folder.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([f"{programs}/cyclorama-grotto", "--kind", kind, "--triangles", str(triangles), "--seed", "1",
                        "--out", folder],
                       check=True, stdout=sys.stderr)
    return folder
