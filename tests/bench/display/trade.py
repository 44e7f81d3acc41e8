# SPDX-License-Identifier: Apache-2.0
"""Of the figures of `display_bench trade`: a table of every point, a drawing, and the JSON line.

Run: trade.py FIGURES FOLDER, where display.csv and display.svg are written.
"""
import csv
import json
import math
import pathlib
import sys

COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44", "#8f5fbf"]
WIDTH, HEIGHT, LEFT, TOP, GAP = 260, 200, 60, 40, 90


def panels(figures):
    """(title, x label, y label, {series: [(x, y)]})"""
    warp = {}
    for point in figures["warp"]:
        if point["error_px"] > 0:
            warp.setdefault(point["kind"], []).append((point["cpu_ms"], point["error_px"]))
    response = {name: [(point["steps"], point[name]) for point in figures["response"]] for name in ("srgb", "gamma_2.2", "gamma_2.6")}
    decode = {}
    for point in figures["decode"]:
        decode.setdefault("4:2:0" if point["half_chroma"] else "4:4:4", []).append((point["threads"], point["wall_ms"]))
    return [("Warp", "cpu ms per full HD head", "error, px", warp), ("Response table", "steps", "error, code values of 8 bits", response),
            ("Decoding 4096 px", "threads", "ms", decode)]


def rows(figures):
    for point in figures["warp"]:
        yield ["warp", point["kind"], point["tolerance_px"], point["cells"], point["error_px"], point["cpu_ms"]]
    for point in figures["response"]:
        for curve in ("srgb", "gamma_2.2", "gamma_2.6"):
            yield ["response", curve, "", point["steps"], point[curve], ""]
    for point in figures["decode"]:
        yield ["decode", "4:2:0" if point["half_chroma"] else "4:4:4", "", point["threads"], "", point["wall_ms"]]


def drawn(number, title, x_label, y_label, series):
    """One panel with logarithmic axes."""
    points = [point for line in series.values() for point in line]
    lows = [math.log10(min(p[axis] for p in points)) for axis in (0, 1)]
    spans = [max(math.log10(max(p[axis] for p in points)) - lows[axis], 0.1) for axis in (0, 1)]
    left = LEFT + number * (WIDTH + GAP)

    def place(point):
        return (left + WIDTH * (math.log10(point[0]) - lows[0]) / spans[0],
                TOP + HEIGHT * (1 - (math.log10(point[1]) - lows[1]) / spans[1]))

    out = [f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           f'<text x="{left}" y="{TOP - 22}" font-weight="bold">{title}</text>',
           f'<text x="{left + WIDTH / 2}" y="{TOP + HEIGHT + 34}" text-anchor="middle">{x_label}</text>',
           f'<text transform="translate({left - 44},{TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">{y_label}</text>']
    for axis in (0, 1):
        for end in (0, 1):
            value = f"{10 ** (lows[axis] + end * spans[axis]):.3g}"
            x, y, anchor = ((left + end * WIDTH, TOP + HEIGHT + 16, "middle") if axis == 0
                            else (left - 5, TOP + HEIGHT * (1 - end) + 4, "end"))
            out.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}">{value}</text>')
    for index, (name, line) in enumerate(series.items()):
        places = [place(point) for point in line]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(f'<polyline points="{path}" fill="none" stroke="{COLOURS[index]}"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLOURS[index]}"/>' for x, y in places]
        out.append(f'<text x="{left + WIDTH - 5}" y="{TOP + 16 + 15 * index}" text-anchor="end" fill="{COLOURS[index]}">{name}</text>')
    return out


def main(source, folder):
    figures = json.loads(pathlib.Path(source).read_text())
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "display.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["knob", "kind", "tolerance_px", "size", "error", "ms"])
        for row in rows(figures):
            writer.writerow([f"{value:.4g}" if isinstance(value, float) else value for value in row])
    shapes = [line for number, panel in enumerate(panels(figures)) for line in drawn(number, *panel)]
    size = (LEFT + 3 * (WIDTH + GAP), TOP + HEIGHT + 50)
    (out / "display.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" font-family="sans-serif" font-size="12">\n'
        f'<rect width="{size[0]}" height="{size[1]}" fill="white"/>\n' + "\n".join(shapes) + "\n</svg>\n", encoding="utf-8")
    print(f"{out}/display.csv, {out}/display.svg")
    print(json.dumps({"benchmark": "display-trade", **figures}))


if __name__ == "__main__":
    main(*sys.argv[1:])
