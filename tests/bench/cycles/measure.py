# SPDX-License-Identifier: Apache-2.0
"""Renders a museum hall with cyclorama-render and Cycles, then compares them: measure.py BUILD_FOLDER SCENE [--quick].

Paths have four edges from the eye to the light; render.py explains how each renderer counts them. --quick renders only
ours.
"""
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
REFERENCE_SAMPLES, SAMPLES, MEAN_SAMPLES = 256, 16, 512


class Renderers:
    def __init__(self, build, scene, folder):
        self.build, self.scene, self.folder = build, scene, folder

    def ours(self, name, *options):
        subprocess.run([f"{self.build}/bin/cyclorama-render", "picture", self.scene, "--camera", "perspective",
                        "--field-deg", "75",
                        "--bounces", "2", "--threads", "2", *map(str, options), "--out", self.folder / f"{name}.pfm"],
                       check=True, stdout=sys.stderr)

    def cycles(self, name, *options):
        done = subprocess.run(["blender", "-b", "--python-exit-code", "1", "--python", HERE / "render.py",
                               "--", self.scene,
                               self.folder / f"{name}.pfm", *map(str, options), "--path-length", "4", "--threads", "2",
                               "--json", self.folder / f"{name}.json"],
                              check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            sys.exit("\n".join(["blender failed; its last lines:", *done.stdout.splitlines()[-20:]]))


def main(build, scene, *options):
    is_quick = "--quick" in options
    size = "240x135" if is_quick else "960x540"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        renderers = Renderers(build, scene, folder)
        # The reference has another seed: its own noise adds a sixteenth or less to the error.
        renderers.ours("reference", "--size", size, "--samples", REFERENCE_SAMPLES, "--seed", 2)
        renderers.ours("ours", "--size", size, "--samples", SAMPLES, "--seed", 1, "--json", folder / "ours.json")
        if not is_quick:
            renderers.cycles("cycles", "--size", size, "--samples", SAMPLES)
            renderers.cycles("defaults", "--size", size, "--samples", SAMPLES, "--defaults")
            renderers.ours("ours-mean", "--size", "240x135", "--samples", MEAN_SAMPLES, "--seed", 3)
            renderers.cycles("cycles-mean", "--size", "240x135", "--samples", MEAN_SAMPLES, "--seed", 3)
        subprocess.run([sys.executable, HERE / "compare.py", folder, "1" if is_quick else "0"], check=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
