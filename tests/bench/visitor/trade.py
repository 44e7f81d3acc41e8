# SPDX-License-Identifier: Apache-2.0
"""Writes a table and a drawing of the figures of `tracker_bench trade` and prints the JSON line.

Run: trade.py FOLDER FIGURES..., where FOLDER gets visitor.csv and visitor.svg. Each file may have a part of the
parameters.
"""
import csv
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from panels import Panel, write_panels  # noqa: E402


def by(points, name, x, y):
    """Returns the series of points for logarithmic axes, without those at zero."""
    series = {}
    for point in points:
        if point[x] > 0 and point[y] > 0:
            series.setdefault(name(point), []).append((point[x], point[y]))
    return series


def panels(points):
    def of(*knobs):
        return [point for point in points if point["knob"] in knobs]

    def distance(point):
        return f"at {point['distance_m']} m"

    filters = [point for point in of("filter") if point["cutoff_hz"] in (0.5, 1.0, 2.0, 4.0)]
    # Too few samples give no meaningful value.
    searches = [point for point in of("decimation", "decimation, tiles") if point["found_share"] > 0.75]
    drawn = [
        Panel("Filter, by cut-off at rest", "lag of the yaw, ms", "jitter at 2 m, degrees",
              by(filters, lambda point: f"{point['cutoff_hz']:g} Hz", "yaw_lag_ms", "yaw_jitter_2m_deg")),
        Panel("Decimation", "ms a picture, one core", "yaw sd at 2 m, degrees",
              by(searches, lambda point: "with tiles" if "tiles" in point["knob"] else "the whole picture", "median_ms",
                 "yaw_sd_deg")),
        Panel("Size of a tag", "mm", "yaw sd, degrees", by(of("tag size, mm"), distance, "value", "yaw_sd_deg"),
              is_linear_across=True),
        Panel("Fold of the card", "degrees", "yaw sd, degrees", by(of("fold, deg"), distance, "value", "yaw_sd_deg"),
              is_linear_across=True),
    ]
    return [panel for panel in drawn if panel.series]


def main(folder, *sources):
    points = [point for source in sources for point in json.loads(pathlib.Path(source).read_text())["points"]]
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(key for point in points for key in point))
    with open(out / "visitor.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        for point in points:
            writer.writerow({key: f"{value:.4g}" if isinstance(value, float) else value
                             for key, value in point.items()})
    write_panels(out / "visitor.svg", panels(points))
    print(f"{out}/visitor.csv, {out}/visitor.svg")
    print(json.dumps({"benchmark": "visitor-trade", "points": points}))


if __name__ == "__main__":
    main(*sys.argv[1:])
