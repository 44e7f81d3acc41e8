#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the picture's error after a bump: curve.py OUT.svg < the last line of ./bench.sh selfcal-bump."""
import json
import math
import sys

WIDTH, HEIGHT, LEFT, BELOW, ABOVE = 760, 360, 60, 44, 16
MIN_PX, MAX_PX = 0.05, 500.0


def main():
    curve = json.loads(sys.stdin.read().strip().splitlines()[-1])["curve_px_p50_p95"]
    seconds = 5.0 / (len(curve) - 1)
    across = lambda s: LEFT + s / 5.0 * (WIDTH - LEFT - 16)
    down = lambda px: ABOVE + (math.log(MAX_PX) - math.log(max(px, MIN_PX))) / (math.log(MAX_PX) - math.log(MIN_PX)) * (HEIGHT - ABOVE - BELOW)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for px in (0.1, 1, 10, 100):
        out.append(f'<path d="M{LEFT} {down(px):.1f}H{WIDTH - 16}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 8}" y="{down(px) + 4:.1f}" text-anchor="end">{px:g} px</text>')
    for s in range(6):
        out.append(f'<text x="{across(s):.1f}" y="{HEIGHT - 22}" text-anchor="middle">{s} s</text>')
    for place, colour, name in ((0, "#1a6", "median"), (1, "#c33", "95th percentile")):
        points = " ".join(f"{across(i * seconds):.1f},{down(v[place]):.1f}" for i, v in enumerate(curve))
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
                   f'<text x="{WIDTH - 20}" y="{ABOVE + 20 + 18 * place}" text-anchor="end" fill="{colour}">{name} of bumps</text>')
    for s, px in ((2, 3), (5, 1)):
        out.append(f'<circle cx="{across(s):.1f}" cy="{down(px):.1f}" r="4" fill="none" stroke="#555"/>'
                   f'<text x="{across(s) - 8:.1f}" y="{down(px) - 7:.1f}" text-anchor="end" fill="#555">goal</text>')
    out.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 4}" text-anchor="middle">after the bump</text></svg>')
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


main()
