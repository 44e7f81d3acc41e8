# SPDX-License-Identifier: Apache-2.0
"""Draws panels of curves side by side as SVG."""
import math
import pathlib
from dataclasses import dataclass

COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44", "#8f5fbf", "#b8860b", "#444444", "#17a2a2"]
WIDTH, HEIGHT, LEFT, TOP, GAP = 260, 200, 60, 40, 90


@dataclass
class Panel:
    """A panel of curves. The vertical axis is logarithmic, and so is the horizontal one unless `is_linear_across`.

    `series` has a list of points (x, y) for each name; coordinates on a logarithmic axis are positive.
    """
    title: str
    x_label: str
    y_label: str
    series: dict
    is_linear_across: bool = False

    def measure(self, point):
        return (point[0] if self.is_linear_across else math.log10(point[0])), math.log10(point[1])

    def value(self, axis, measure):
        return measure if axis == 0 and self.is_linear_across else 10 ** measure


def drawn(number, panel):
    points = [panel.measure(point) for line in panel.series.values() for point in line]
    lows = [min(p[axis] for p in points) for axis in (0, 1)]
    spans = [max(max(p[axis] for p in points) - lows[axis], 0.1) for axis in (0, 1)]
    left = LEFT + number * (WIDTH + GAP)

    def place(point):
        across, up = ((measure - low) / span for measure, low, span in zip(panel.measure(point), lows, spans))
        return left + WIDTH * across, TOP + HEIGHT * (1 - up)

    out = [f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           f'<text x="{left}" y="{TOP - 22}" font-weight="bold">{panel.title}</text>',
           f'<text x="{left + WIDTH / 2}" y="{TOP + HEIGHT + 34}" text-anchor="middle">{panel.x_label}</text>',
           f'<text transform="translate({left - 44},{TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">{panel.y_label}</text>']
    for axis in (0, 1):
        for end in (0, 1):
            value = f"{panel.value(axis, lows[axis] + end * spans[axis]):.3g}"
            x, y, anchor = ((left + end * WIDTH, TOP + HEIGHT + 16, "middle") if axis == 0
                            else (left - 5, TOP + HEIGHT * (1 - end) + 4, "end"))
            out.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}">{value}</text>')
    for index, (name, line) in enumerate(panel.series.items()):
        places = [place(point) for point in line]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(f'<polyline points="{path}" fill="none" stroke="{COLOURS[index]}"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLOURS[index]}"/>' for x, y in places]
        out.append(f'<text x="{left + WIDTH - 5}" y="{TOP + 16 + 15 * index}" text-anchor="end" fill="{COLOURS[index]}">{name}</text>')
    return out


def write_panels(file, panels):
    """Writes the panels to the SVG `file`, from left to right."""
    shapes = [line for number, panel in enumerate(panels) for line in drawn(number, panel)]
    size = (LEFT + len(panels) * (WIDTH + GAP), TOP + HEIGHT + 50)
    pathlib.Path(file).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" font-family="sans-serif" font-size="12">\n'
        f'<rect width="{size[0]}" height="{size[1]}" fill="white"/>\n' + "\n".join(shapes) + "\n</svg>\n",
        encoding="utf-8")
