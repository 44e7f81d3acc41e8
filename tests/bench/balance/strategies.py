# SPDX-License-Identifier: Apache-2.0
"""Records the costs of frames, replays them on simulated nodes by each strategy, and draws Figure 9.

Run: strategies.py BUILD_FOLDER [--quick]. Everything is left in build/balance.
"""
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import generated  # noqa: E402

OUT = pathlib.Path("build/balance")
FULL = {"triangles": 400000, "frames": 120, "size": "960x540", "nodes": "4,8,16,32,64,256,1024,4096",
        "samples": {"interior": 1, "walk": 1, "void": 4}, "sizes": [60000, 1000000, 6000000]}
QUICK = {"triangles": 60000, "frames": 24, "size": "480x270", "nodes": "16,64",
         "samples": {"interior": 1, "walk": 1, "void": 1}, "sizes": [60000, 1000000]}
SCENES = {"interior": ("interior", "orbit"), "walk": ("grotto", "walk"), "void": ("relic", "orbit")}
FIGURE_FRAMES = 4


class Balance:
    """cyclorama-bench-balance and the scenes that it records."""

    def __init__(self, build):
        self.build = build

    def run(self, *words, to=None):
        sys.stdout.flush()
        subprocess.run([f"{self.build}/tests/cyclorama-bench-balance", *map(str, words)], check=True, stdout=to)

    def scene(self, kind, triangles):
        return generated.scene(kind, triangles, f"{self.build}/bin")

    def record(self, scene, name, *options):
        """Returns the file of costs that it wrote."""
        file = OUT / f"{name}.costs"
        self.run("record", scene, *options, "--out", file, to=sys.stderr)
        return file

    def replay(self, name, files, *options):
        self.run("replay", *files, *options, "--json", OUT / f"{name}.json")


def figure9(balance, of):
    """Direct light in grottoes of several sizes, so that the small ones are soon done; the largest path traced, too."""
    walk = ["--path", "walk", "--size", of["size"], "--frames", FIGURE_FRAMES]
    files = []
    for n in of["sizes"]:
        file = balance.record(balance.scene("grotto", n), f"figure9-{n}", *walk, "--samples", 1, "--bounces", 0)
        files.append(f"{n // 1000}k triangles={file}")
    largest = of["sizes"][-1]
    file = balance.record(balance.scene("grotto", largest), "figure9-paths", *walk, "--samples", 2)
    files.append(f"{largest // 1000}k, path traced={file}")
    print(flush=True)
    balance.run("figure9", *files, "--svg", OUT / "figure9.svg", "--json", OUT / "figure9.json")


def summary():
    rows = json.loads((OUT / "replay.json").read_text())
    found = {pathlib.Path(row["file"]).name.split(".")[0]: row
             for row in rows if row["nodes"] == 16 and row["strategy"] == "cost-map-stealing"}
    ours = {name: found[name] for name in SCENES}
    pairs = {f"{name}16": {"mean": round(row["mean"], 3), "p5": round(row["p5"], 3)} for name, row in ours.items()}
    return {"benchmark": "balance", **pairs, "gain_mean": round(sum(row["gain"] for row in ours.values()) / len(ours), 3),
            "frames_below_equal": sum(row["below_equal"] for row in ours.values()),
            "plan_ms_64": round(json.loads((OUT / "large.json").read_text())[0]["plan_ms"], 3)}


def main(build, *options):
    is_quick = "--quick" in options
    of = QUICK if is_quick else FULL
    balance = Balance(build)
    OUT.mkdir(parents=True, exist_ok=True)
    for old in OUT.glob("*.costs"):
        old.unlink()
    rows = []
    for name, (kind, path) in SCENES.items():
        rows.append(balance.record(balance.scene(kind, of["triangles"]), name, "--path", path, "--size", of["size"],
                                   "--frames", of["frames"], "--samples", of["samples"][name]))
    # Real data, where they are, add a row to the table; the summary leaves them out.
    coordinator = pathlib.Path(os.environ.get("CYCLORAMA_SHARED", "../shared")) / "data/relics/buddha_head_1m.ply"
    real = []
    if not is_quick and coordinator.is_file():
        real.append(balance.record(coordinator, "buddha_head", "--size", of["size"], "--frames", 60, "--samples", 2))
    balance.replay("replay", rows + real, "--nodes", of["nodes"])
    print("\nNodes of speeds from 0.25 to 4:", flush=True)
    balance.replay("unequal", rows, "--nodes", 16, "--unequal")
    # Planning a picture of 1920x1080 for 64 nodes: enough frames for a median.
    large = balance.record(balance.scene("interior", of["triangles"]), "large", "--size", "1920x1080", "--frames", 12,
                           "--samples", 1, "--bounces", 0)
    balance.replay("large", [large], "--nodes", 64, "--strategy", "cost-map-stealing")
    figure9(balance, of)
    print(json.dumps(summary()))


if __name__ == "__main__":
    main(*sys.argv[1:])
