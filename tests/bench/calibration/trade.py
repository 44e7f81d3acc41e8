# SPDX-License-Identifier: Apache-2.0
"""Of the figures of `calibration_bench trade`: a table of every point, a drawing (large dots: the defaults), and the JSON line.

Run: trade.py FIGURES FOLDER, where calibration.csv and calibration.svg are written.
"""
import csv
import json
import math
import pathlib
import sys

COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44", "#8f5fbf"]
WIDTH, HEIGHT, LEFT, TOP = 520, 320, 60, 30


def place_in(points):
    """Logarithmic axes: museum's seconds across, registration's p95 up."""
    ends = []
    for key in ("museum_s", "p95_px"):
        values = [math.log10(max(point[key], 1e-4)) for point in points]
        low, high = min(values), max(values)
        margin = max(0.05, 0.06 * (high - low))
        ends.append((low - margin, high + margin))

    def place(point):
        across, up = ((math.log10(max(point[key], 1e-4)) - low) / (high - low) for key, (low, high) in zip(("museum_s", "p95_px"), ends))
        return LEFT + WIDTH * across, TOP + HEIGHT * (1 - up)

    return place, ends


def drawing(points):
    points = [point for point in points if not point["knob"].startswith("model")]  # One scan, another drawing: no time of their own.
    place, ends = place_in(points)
    out = [f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           f'<text x="{LEFT + WIDTH / 2}" y="{TOP + HEIGHT + 34}" text-anchor="middle">seconds in the museum</text>',
           f'<text transform="translate({LEFT - 44},{TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">registration p95, projector px</text>']
    for end in (0, 1):
        out.append(f'<text x="{LEFT + end * WIDTH}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{10 ** ends[0][end]:.3g}</text>')
        out.append(f'<text x="{LEFT - 5}" y="{TOP + HEIGHT * (1 - end) + 4}" text-anchor="end">{10 ** ends[1][end]:.2g}</text>')
    knobs = {}
    for point in points:
        knobs.setdefault(point["knob"], []).append(point)
    for index, (knob, line) in enumerate(knobs.items()):
        colour = COLOURS[index % len(COLOURS)]
        places = [place(point) for point in line]
        if knob != "patterns":
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            out.append(f'<polyline points="{path}" fill="none" stroke="{colour}"/>')
        for point, (x, y) in zip(line, places):
            out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{5 if point["default"] else 3}" fill="{colour}"/>')
            out.append(f'<text x="{x + 5:.1f}" y="{y - 4:.1f}" font-size="9" fill="{colour}">{point["value"]}</text>')
        out.append(f'<text x="{LEFT + WIDTH - 5}" y="{TOP + 16 + 15 * index}" text-anchor="end" fill="{colour}">{knob}</text>')
    size = (LEFT + WIDTH + 60, TOP + HEIGHT + 50)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" font-family="sans-serif" font-size="12">\n'
            f'<rect width="{size[0]}" height="{size[1]}" fill="white"/>\n' + "\n".join(out) + "\n</svg>\n")


def main(source, folder):
    points = json.loads(pathlib.Path(source).read_text())
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "calibration.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(points[0].keys())
        for point in points:
            writer.writerow([f"{value:.4g}" if isinstance(value, float) else value for value in point.values()])
    (out / "calibration.svg").write_text(drawing(points), encoding="utf-8")
    print(f"{out}/calibration.csv, {out}/calibration.svg")
    print(json.dumps({"benchmark": "calibration-trade", "points": len(points), "figures": points}))


if __name__ == "__main__":
    main(*sys.argv[1:])
