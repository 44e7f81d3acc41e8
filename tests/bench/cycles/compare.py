# SPDX-License-Identifier: Apache-2.0
"""Prints the table and the JSON line of tracer-equal-error: compare.py FOLDER QUICK."""
import array
import json
import pathlib
import sys

EPSILON = 0.01  # In relMSE: (picture - reference)^2 / (reference^2 + EPSILON), mean over pixels and channels.

folder, quick = pathlib.Path(sys.argv[1]), sys.argv[2] == "1"


def read(name):
    """Returns the values of a little-endian colour PFM in the file's order."""
    data = (folder / f"{name}.pfm").read_bytes()
    header, rest = data.split(b"\n", 3)[:3], data.split(b"\n", 3)[3]
    assert header[0] == b"PF" and float(header[2]) < 0, name
    values = array.array("f")
    values.frombytes(rest)
    return values


def relmse(name, reference):
    pairs = list(zip(read(name), reference))
    return sum((a - b) * (a - b) / (b * b + EPSILON) for a, b in pairs) / len(pairs)


def cpu_seconds(name):
    return json.loads((folder / f"{name}.json").read_text())["cpu_s"]


reference = read("reference")
result = {"benchmark": "tracer-equal-error"}
for name, prefix in [("ours", "")] + ([] if quick else [("cycles", "cycles_"), ("defaults", "cycles_defaults_")]):
    error, seconds = relmse(name, reference), cpu_seconds(name)
    print(f"{name:<10} relMSE {error:.5f}   cpu-seconds {seconds:7.2f}   product {error * seconds:.4f}")
    result |= {prefix + "relmse": round(error, 6), prefix + "cpu_s": round(seconds, 3),
               prefix + "relmse_cpu_s": round(error * seconds, 5)}
if not quick:
    ours, cycles = read("ours-mean"), read("cycles-mean")
    # One pair for each channel; the first row is at the bottom in both.
    means = [(sum(ours[k::3]) / len(ours) * 3, sum(cycles[k::3]) / len(cycles) * 3) for k in range(3)]
    worst = max(abs(a / b - 1) for a, b in means)
    print("mean       " + "   ".join(f"{a:.6f} ours, {b:.6f} Cycles" for a, b in means) + f"   differ by {worst:.2e}")
    result |= {"mean_difference": worst, "cycles": json.loads((folder / "cycles.json").read_text())["version"]}
print(json.dumps(result))
