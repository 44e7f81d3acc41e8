# SPDX-License-Identifier: Apache-2.0
"""Writes a table and a drawing of the figures of `calibration_bench trade` and prints the JSON line.

Large dots are the defaults. Run: trade.py FIGURES FOLDER, which gets calibration.csv and calibration.svg.
"""
import csv
import json
import math
import pathlib
import sys

COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44", "#8f5fbf"]
WIDTH, HEIGHT, LEFT, TOP, ACROSS = 360, 220, 60, 30, 2


def place_in(points):
    """Returns the logarithmic axes (seconds across, registration p95 up) as a function of a point, and their ends."""
    ends = []
    for key in ("museum_s", "p95_px"):
        values = [math.log10(max(point[key], 1e-4)) for point in points]
        low, high = min(values), max(values)
        margin = max(0.05, 0.06 * (high - low))
        ends.append((low - margin, high + margin))

    def place(point):
        across, up = ((math.log10(max(point[key], 1e-4)) - low) / (high - low)
                      for key, (low, high) in zip(("museum_s", "p95_px"), ends))
        return LEFT + WIDTH * across, TOP + HEIGHT * (1 - up)

    return place, ends


def panel(knob, points, place, ends, colour):
    """Draws one parameter; all panels have the same axes."""
    out = [f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           f'<text x="{LEFT}" y="{TOP - 8}" font-weight="bold">{knob}</text>']
    for end in (0, 1):
        out.append(f'<text x="{LEFT + end * WIDTH}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{10 ** ends[0][end]:.3g} s</text>')
        out.append(f'<text x="{LEFT - 5}" y="{TOP + HEIGHT * (1 - end) + 4}" text-anchor="end">{10 ** ends[1][end]:.2g} px</text>')
    places = [place(point) for point in points]
    if knob != "patterns":
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}"/>')
    taken = []
    for point, (x, y) in sorted(zip(points, places), key=lambda at: at[1][1]):
        # Each label moves down until it is clear of the one above.
        at = max([y + 4] + [other + 11 for other_x, other in taken if abs(other_x - x) < 150])
        taken.append((x, at))
        out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{5 if point["default"] else 3}" fill="{colour}"/>')
        out.append(f'<text x="{x + 8:.1f}" y="{at:.1f}" font-size="10" fill="{colour}">{point["value"]}</text>')
    return out


def drawing(points):
    # Models share one scan and have another drawing.
    points = [point for point in points if not point["knob"].startswith("model")]
    place, ends = place_in(points)
    knobs = {}
    for point in points:
        knobs.setdefault(point["knob"], []).append(point)
    wide, high = LEFT + WIDTH + 60, TOP + HEIGHT + 36
    out = []
    for index, (knob, line) in enumerate(knobs.items()):
        out.append(f'<g transform="translate({index % ACROSS * wide},{index // ACROSS * high})">')
        out += panel(knob, line, place, ends, COLOURS[index % len(COLOURS)])
        out.append("</g>")
    size = (wide * ACROSS, high * math.ceil(len(knobs) / ACROSS) + 24)
    out.append(f'<text x="10" y="{size[1] - 8}">Across: seconds in the museum; up: registration p95, projector px; both logarithmic. '
               'Large dots: the defaults.</text>')
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
