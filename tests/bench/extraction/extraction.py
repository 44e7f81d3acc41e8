#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a hostile museum can make of its pictures: the recovered surface against the number of views, by defence.

Run: extraction.py BUILD_FOLDER SCENE JSON [--views 16 32 ...] [--only DEFENCE ...] [--keep FOLDER]

The attacker has the eye of each picture, because he requested it, so COLMAP only has to match and to triangulate. Its
dense part needs a graphics card; its sparse points tell how exact a denser reconstruction would be, and where. The row
`depth` is another attack: a museum that asks for View.depth gets a distance for each 4x4 pixels, without any matching.
Ends with 77 where COLMAP, NumPy or SciPy is missing (scripts/install-packages bench).
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

try:
    import numpy

    import colmap
    import truth
except ImportError as missing:
    print(f"left out: {missing} (scripts/install-packages bench)", file=sys.stderr)
    sys.exit(77)

WIDTH, HEIGHT, FIELD_DEG = 1024, 768, 75.0
PLACE_M = 0.25  # The farm counts places in squares of this size (renderfarm/trust/view_guard.h).
KEY = 0x9E1F2BAD2AF9EA4E
DEFENCES = {
    "none": {},
    "watermark": {"options": ["--watermark", KEY]},
    "warp 0.25 px": {"options": ["--warp-px", 0.25]},
    "warp 1 px": {"options": ["--warp-px", 1.0]},
    "half size at known places": {"full_views_per_place": 1},
    "quota of 8 places": {"places": 8},
}


def walk(scene, count):
    """Returns so many views of a walk along the walkable area, as a visitor may go: at each place the next direction."""
    room = tomllib.loads((scene / "scene.toml").read_text())
    corners = numpy.array(room["visitor"]["walkable_m"])
    eye = numpy.array(room["start"]["eye_m"])
    x0, x1 = corners[:, 0].min() * 0.45, corners[:, 0].max() * 0.45
    z0, z1 = eye[2] * 0.35, eye[2] * 0.95
    views = []
    for i in range(count):
        along = (i + 0.5) / count
        z = z0 + (z1 - z0) * (0.5 - 0.5 * numpy.cos(2 * numpy.pi * 3 * along))
        heading = room["start"].get("heading_deg", 0.0) + 35.0 * numpy.sin(2 * numpy.pi * 5 * along)
        views.append({"name": f"{i:04}.jpg", "eye": [float(x0 + (x1 - x0) * along), float(eye[1]), float(z)],
                      "heading_deg": float(heading), "tilt_deg": float(12.0 * numpy.sin(2 * numpy.pi * 2 * along)), "scale": 1.0})
    return views


def defended(views, full_views_per_place=None, places=None):
    """Returns the views that a defence leaves, and makes those smaller that it would."""
    seen = {}
    left = []
    for view in views:
        place = tuple(int(numpy.floor(view["eye"][axis] / PLACE_M)) for axis in (0, 2))
        if places is not None and place not in seen and len(seen) == places:
            continue
        seen[place] = seen.get(place, 0) + 1
        coarse = full_views_per_place is not None and seen[place] > full_views_per_place
        left.append(dict(view, scale=0.5 if coarse else 1.0))
    return left, len(seen)


def pictures(build, scene, light, views, folder, options):
    folder.mkdir()
    listing = folder / "views"
    listing.write_text("".join(f"{v['name']} {v['eye'][0]} {v['eye'][1]} {v['eye'][2]} {v['heading_deg']} {v['tilt_deg']} {v['scale']}\n"
                               for v in views))
    subprocess.run([f"{build}/tests/cyclorama-bench-museum", scene, "--views", listing, "--out", folder, "--light", light,
                    "--width", str(WIDTH), "--height", str(HEIGHT), "--field-deg", str(FIELD_DEG), "--json", folder / "flip.json",
                    *map(str, options)], check=True, stdout=sys.stderr)
    return json.loads((folder / "flip.json").read_text())["flip"]


def from_depth(folder, views, focal):
    """Returns the points that the views' depth gives, in scene metres."""
    found = []
    for view in views:
        width, height = int(WIDTH * view["scale"]), int(HEIGHT * view["scale"])
        columns, rows = -(-width // 4), -(-height // 4)
        inverse = numpy.fromfile(folder / f"{view['name']}.depth", "<u2").reshape(rows, columns) / (4095 * 0.1)
        u, v = numpy.meshgrid((numpy.arange(columns) + 0.5) * 4 - width / 2, (numpy.arange(rows) + 0.5) * 4 - height / 2)
        rays = numpy.stack([u, v, numpy.full_like(u, focal * view["scale"])], -1)
        rays /= numpy.linalg.norm(rays, axis=-1, keepdims=True)
        known = (inverse > 0) & (inverse < 10)
        rotation, translation = colmap.camera_from_scene(view)
        camera = rays[known] / inverse[known][:, None]
        found.append((camera - translation) @ rotation)
    return numpy.concatenate(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("json", type=pathlib.Path)
    parser.add_argument("--views", type=int, nargs="+", default=[16, 32, 64, 128])
    parser.add_argument("--only", nargs="+", choices=list(DEFENCES), default=list(DEFENCES))
    parser.add_argument("--keep", type=pathlib.Path, help="keeps pictures and points there")
    arguments = parser.parse_args()
    if shutil.which("colmap") is None:
        print("left out: colmap is not installed (scripts/install-packages bench)", file=sys.stderr)
        return 77
    focal = 0.5 * WIDTH / numpy.tan(numpy.radians(FIELD_DEG) / 2)
    camera = {"width": WIDTH, "height": HEIGHT, "focal": focal}
    surface = truth.Surface(arguments.scene)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        top = arguments.keep or pathlib.Path(name)
        top.mkdir(parents=True, exist_ok=True)
        light = top / "light.store"
        if not light.exists():
            subprocess.run([f"{arguments.build}/bin/cyclorama-render", "light", arguments.scene, "--out", light, "--check-eyes", "0"],
                           check=True, stdout=sys.stderr)
        most = walk(arguments.scene, max(arguments.views))
        reference = top / "reference"
        if not reference.exists():
            pictures(arguments.build, arguments.scene, light, most, reference, [])
        seen = truth.places(from_depth(reference, most, focal))
        print(f"{arguments.scene.name}: {len(surface.corners)} triangles, {len(seen)} places of {100 * truth.CELL_M:.0f} cm seen; "
              f"pictures of {WIDTH}x{HEIGHT}, {FIELD_DEG:.0f} degrees, {1e3 / focal:.1f} mm a pixel at 1 m")
        print(f"{'attack':<8}{'defence':<28}{'views':>6}{'FLIP':>8}{'points':>9}{'mm rms':>8}{'median':>8}{'wrong':>8}{'coverage':>10}")
        for defence in arguments.only:
            settings = DEFENCES[defence]
            for count in arguments.views if defence in ("none", "quota of 8 places") else [arguments.views[-1]]:
                views, taken = defended(walk(arguments.scene, count), settings.get("full_views_per_place"), settings.get("places"))
                work = top / f"{defence}-{count}".replace(" ", "_")
                shutil.rmtree(work, ignore_errors=True)
                work.mkdir()
                flip = pictures(arguments.build, arguments.scene, light, views, work / "pictures", settings.get("options", []))
                for attack in ("colmap", "depth") if defence in ("none", "quota of 8 places") else ("colmap",):
                    points = (colmap.points(work / "pictures", work, views, camera) if attack == "colmap" else
                              from_depth(work / "pictures", views, focal))
                    if arguments.keep:
                        numpy.save(work / f"{attack}.npy", points)
                    row = {"attack": attack, "defence": defence, "views": len(views), "places": taken, "flip": round(flip, 4),
                           **truth.recovered(surface, seen, points)}
                    rows.append(row)
                    shown = [row[key] if row[key] is not None else "-" for key in ("points", "mm_rms", "mm_median", "wrong", "coverage")]
                    print(f"{attack:<8}{defence:<28}{row['views']:>6}{row['flip']:>8.4f}{shown[0]:>9}{shown[1]:>8}{shown[2]:>8}"
                          f"{shown[3]:>8}{shown[4]:>10}", flush=True)
    arguments.json.write_text(json.dumps({"benchmark": "extraction", "scene": arguments.scene.name, "rows": rows}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
