# SPDX-License-Identifier: Apache-2.0
"""COLMAP as an attacker runs it on pictures whose eyes he knows, because he asked for them: its sparse part, on CPUs."""
import os
import sqlite3
import subprocess

import numpy

THREADS = str(os.cpu_count())


def run(command, *options):
    environment = dict(os.environ, QT_QPA_PLATFORM="offscreen")
    result = subprocess.run(["colmap", command, *map(str, options)], env=environment, text=True, capture_output=True)
    if result.returncode != 0:
        raise SystemExit(f"colmap {command} failed:\n{result.stdout[-2000:]}{result.stderr[-2000:]}")


def quaternion(rotation):
    """Returns w, x, y, z of a rotation whose trace is not near -1, or of the one that its largest diagonal gives."""
    m = rotation
    candidates = [1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2],
                  1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]]
    i = int(numpy.argmax(candidates))
    s = 2.0 * numpy.sqrt(candidates[i])
    rows = [[s / 4, (m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s],
            [(m[2, 1] - m[1, 2]) / s, s / 4, (m[0, 1] + m[1, 0]) / s, (m[0, 2] + m[2, 0]) / s],
            [(m[0, 2] - m[2, 0]) / s, (m[0, 1] + m[1, 0]) / s, s / 4, (m[1, 2] + m[2, 1]) / s],
            [(m[1, 0] - m[0, 1]) / s, (m[0, 2] + m[2, 0]) / s, (m[1, 2] + m[2, 1]) / s, s / 4]]
    return rows[i]


def camera_from_scene(view):
    """Returns rotation and translation: the camera's x to the right, y down, z forward; at heading 0 it looks along -z."""
    heading, tilt = numpy.radians(view["heading_deg"]), numpy.radians(view["tilt_deg"])
    forward = numpy.array([numpy.sin(heading) * numpy.cos(tilt), numpy.sin(tilt), -numpy.cos(heading) * numpy.cos(tilt)])
    right = numpy.array([numpy.cos(heading), 0.0, numpy.sin(heading)])
    rotation = numpy.array([right, numpy.cross(forward, right), forward])
    return rotation, -rotation @ numpy.array(view["eye"])


def known_model(database, folder, views, camera):
    """Writes the model of the known eyes, by the numbers that the database gave to the pictures."""
    with sqlite3.connect(database) as connection:
        numbers = dict(connection.execute("SELECT name, image_id FROM images"))
    folder.mkdir()
    (folder / "cameras.txt").write_text(f"1 PINHOLE {camera['width']} {camera['height']} {camera['focal']} {camera['focal']} "
                                        f"{camera['width'] / 2} {camera['height'] / 2}\n")
    lines = []
    for view in views:
        rotation, translation = camera_from_scene(view)
        pose = " ".join(f"{value:.12g}" for value in [*quaternion(rotation), *translation])
        lines.append(f"{numbers[view['name']]} {pose} 1 {view['name']}\n\n")
    (folder / "images.txt").write_text("".join(lines))
    (folder / "points3D.txt").write_text("")


def points(pictures, work, views, camera):
    """Returns the points that are found on `views`, pictures in the folder `pictures`, in the scene's metres."""
    database = work / "database.db"
    names = work / "names.txt"
    names.write_text("".join(view["name"] + "\n" for view in views))
    intrinsics = f"{camera['focal']},{camera['focal']},{camera['width'] / 2},{camera['height'] / 2}"
    run("feature_extractor", "--database_path", database, "--image_path", pictures, "--image_list_path", names,
        "--ImageReader.single_camera", 1, "--ImageReader.camera_model", "PINHOLE", "--ImageReader.camera_params", intrinsics,
        "--SiftExtraction.use_gpu", 0, "--SiftExtraction.num_threads", THREADS, "--SiftExtraction.max_num_features", 4096)
    pairs = work / "pairs.txt"
    pairs.write_text("".join(f"{a} {b}\n" for a, b in pairs_of(views)))
    run("matches_importer", "--database_path", database, "--match_list_path", pairs, "--match_type", "pairs",
        "--SiftMatching.use_gpu", 0, "--SiftMatching.num_threads", THREADS)
    known_model(database, work / "known", views, camera)
    found = work / "found"
    found.mkdir()
    run("point_triangulator", "--database_path", database, "--image_path", pictures, "--input_path", work / "known",
        "--output_path", found)
    run("model_converter", "--input_path", found, "--output_path", found, "--output_type", "TXT")
    rows = [line.split() for line in (found / "points3D.txt").read_text().splitlines() if not line.startswith("#")]
    return numpy.array([[float(value) for value in row[1:4]] for row in rows]).reshape(-1, 3)


def pairs_of(views, nearest=12):
    """Returns pairs of pictures that may show the same: of each, those of the nearest eyes with similar directions."""
    eyes = numpy.array([view["eye"] for view in views])
    headings = numpy.radians([view["heading_deg"] for view in views])
    found = set()
    for i in range(len(views)):
        turn = numpy.abs((headings - headings[i] + numpy.pi) % (2 * numpy.pi) - numpy.pi)
        distance = numpy.linalg.norm(eyes - eyes[i], axis=1) + 1.5 * turn
        distance[(turn > 1.0) | (numpy.linalg.norm(eyes - eyes[i], axis=1) < 0.02)] = numpy.inf
        for j in numpy.argsort(distance)[:nearest]:
            if j != i and numpy.isfinite(distance[j]):
                found.add((min(i, int(j)), max(i, int(j))))
    return [(views[i]["name"], views[j]["name"]) for i, j in sorted(found)]
