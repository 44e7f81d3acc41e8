# SPDX-License-Identifier: Apache-2.0
"""Writes a table and a drawing of the figures of `selfcal_bench trade` and prints the JSON line.

Run: trade.py FIGURES FOLDER, which gets selfcal.csv and selfcal.svg.
"""
import csv
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from panels import Panel, write_panels  # noqa: E402

# The horizontal axis of each parameter's panel.
ACROSS = {"rate_hz": ("Corrections", "pictures compared per second", lambda p: p["value"]),
          "patch_step_px": ("Patches", "patches that fit, in three cameras", lambda p: p["patches"]),
          "patch_radius_px": ("A patch's size", "pixels of the camera across", lambda p: 2 * p["value"] + 1),
          "camera_megapixels": ("Cameras", "megapixels", lambda p: p["value"]),
          "walk": ("The filter's window", "seconds", lambda p: p["window_s"])}
UP = {"off, p50, px": "p50_px", "off, p95, px": "p95_px", "7 px healed after, s": "far_healed_s",
      "1 px healed after, s": "near_healed_s", "cores": "cores"}


def panels(points):
    for knob, (title, label, across) in ACROSS.items():
        # A value of zero has no place on a logarithmic axis.
        line = sorted((p for p in points if p["knob"] == knob and across(p) > 0), key=across)
        if len(line) > 1:  # One point makes no curve.
            yield Panel(title, label, "px, s, cores",
                        {name: [(across(p), max(p[key], 1e-3)) for p in line] for name, key in UP.items()})


def main(source, folder):
    points = json.loads(pathlib.Path(source).read_text())
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "selfcal.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(points[0].keys())
        for point in points:
            writer.writerow([f"{value:.4g}" if isinstance(value, float) else value for value in point.values()])
    write_panels(out / "selfcal.svg", list(panels(points)))
    print(f"{out}/selfcal.csv, {out}/selfcal.svg")
    print(json.dumps({"benchmark": "selfcal-trade", "points": len(points), "figures": points}))


if __name__ == "__main__":
    main(*sys.argv[1:])
