# SPDX-License-Identifier: Apache-2.0
"""Draws each sweep in the records of `solve_bench extremes`: the error against the swept value.

Run: extremes_plot.py RECORDS.jsonl OUT.svg
"""
import json
import pathlib
import re
import sys

COLOURS = {"p95_px": "#1b6ca8", "max_px": "#d1495b", "after_noise_p95_px": "#3a7d44"}
WORDS = {"p95_px": "p95", "max_px": "max", "after_noise_p95_px": "p95 after a noisy calibration"}
WIDTH, HEIGHT, LEFT, TOP, GAP_X, GAP_Y, ACROSS = 230, 130, 60, 60, 70, 75, 4
MAX_PX = 1.2


def sweeps(records):
    """Returns {name: [(x, record)]}, both in the order of the runs. Refused cases have no error."""
    found = {}
    for record in records:
        match = re.match(r"(.*?) ?(-?\d+\.?\d*)( .*)? seed \d+$", record["key"])
        name = (match[1].removesuffix(" of") + (match[3] or "")).strip()
        found.setdefault(name, {}).setdefault(float(match[2]), []).append(record)
    return {name: sorted(points.items()) for name, points in found.items()}


def drawn(number, name, points):
    """Returns one panel. Swept values are evenly spaced, since most sweeps are neither linear nor logarithmic."""
    left = LEFT + (number % ACROSS) * (WIDTH + GAP_X)
    top = TOP + (number // ACROSS) * (HEIGHT + GAP_Y)
    step = WIDTH / max(1, len(points))
    out = [f'<rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           f'<text x="{left}" y="{top - 8}" font-weight="bold">{name}</text>']
    for value in (0, 0.5, 1):
        y = top + HEIGHT * (1 - value / MAX_PX)
        out.append(f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{value} px</text>')
        out.append(f'<line x1="{left}" x2="{left + WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
    for i, (x, _) in enumerate(points):
        out.append(f'<text x="{left + (i + 0.5) * step:.1f}" y="{top + HEIGHT + 15}" text-anchor="middle">{x:g}</text>')
    for key, colour in COLOURS.items():
        places = []
        for i, (_, seeds) in enumerate(points):
            values = [seed[key] for seed in seeds if key in seed]
            if values:
                places.append((left + (i + 0.5) * step, top + HEIGHT * (1 - min(max(values), MAX_PX) / MAX_PX)))
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{colour}"/>' for x, y in places]
    for i, (_, seeds) in enumerate(points):
        if all("refused" in seed for seed in seeds):
            out.append(f'<text x="{left + (i + 0.5) * step:.1f}" y="{top + HEIGHT - 6}" text-anchor="middle">×</text>')
    return out


def main(source, target):
    records = [json.loads(line) for line in pathlib.Path(source).read_text(encoding="utf-8").splitlines()]
    shapes, panels = [], sweeps(records)
    for number, (name, points) in enumerate(panels.items()):
        shapes += drawn(number, name, points)
    for number, (key, colour) in enumerate(COLOURS.items()):
        shapes.append(f'<text x="{LEFT + 200 * number}" y="22" fill="{colour}">{WORDS[key]}</text>')
    shapes.append(f'<text x="{LEFT + 200 * len(COLOURS)}" y="22">× refused with a remedy</text>')
    rows = (len(panels) + ACROSS - 1) // ACROSS
    size = (LEFT + ACROSS * (WIDTH + GAP_X), TOP + rows * (HEIGHT + GAP_Y))
    pathlib.Path(target).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" font-family="sans-serif" font-size="12">\n'
        f'<rect width="{size[0]}" height="{size[1]}" fill="white"/>\n' + "\n".join(shapes) + "\n</svg>\n",
        encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
