# SPDX-License-Identifier: Apache-2.0
"""Writes a table and a drawing of the figures of `display_bench trade` and prints the JSON line.

Run: trade.py FIGURES FOLDER, which gets display.csv and display.svg.
"""
import csv
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from panels import Panel, write_panels  # noqa: E402


def panels(figures):
    warp = {}
    for point in figures["warp"]:
        if point["error_px"] > 0:
            warp.setdefault(point["kind"], []).append((point["cpu_ms"], point["error_px"]))
    response = {name: [(point["steps"], point[name]) for point in figures["response"]]
                for name in ("srgb", "gamma_2.2", "gamma_2.6")}
    decode = {}
    for point in figures["decode"]:
        decode.setdefault("4:2:0" if point["half_chroma"] else "4:4:4", []).append((point["threads"], point["wall_ms"]))
    return [Panel("Warp", "cpu ms per full HD head", "error, px", warp),
            Panel("Response table", "steps", "error, code values of 8 bits", response),
            Panel("Decoding 4096 px", "threads", "ms", decode)]


def rows(figures):
    for point in figures["warp"]:
        yield ["warp", point["kind"], point["tolerance_px"], point["cells"], point["error_px"], point["cpu_ms"]]
    for point in figures["response"]:
        for curve in ("srgb", "gamma_2.2", "gamma_2.6"):
            yield ["response", curve, "", point["steps"], point[curve], ""]
    for point in figures["decode"]:
        yield ["decode", "4:2:0" if point["half_chroma"] else "4:4:4", "", point["threads"], "", point["wall_ms"]]


def main(source, folder):
    figures = json.loads(pathlib.Path(source).read_text())
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "display.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["knob", "kind", "tolerance_px", "size", "error", "ms"])
        for row in rows(figures):
            writer.writerow([f"{value:.4g}" if isinstance(value, float) else value for value in row])
    write_panels(out / "display.svg", panels(figures))
    print(f"{out}/display.csv, {out}/display.svg")
    print(json.dumps({"benchmark": "display-trade", **figures}))


if __name__ == "__main__":
    main(*sys.argv[1:])
