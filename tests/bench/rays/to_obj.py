# SPDX-License-Identifier: Apache-2.0
"""Writes the geometry of a package from cyclorama-grotto --kind interior as one OBJ: to_obj.py PACKAGE OUT.obj."""
import pathlib
import sys
import tomllib

import numpy as np

package = pathlib.Path(sys.argv[1])
first = 1
with open(sys.argv[2], "w") as out:
    for geometry in tomllib.loads((package / "scene.toml").read_text())["geometry"]:
        with open(package / geometry["file"], "rb") as file:
            counts = {}
            for line in iter(lambda: file.readline().decode("ascii").split(), ["end_header"]):
                if line[0] == "element":
                    counts[line[1]] = int(line[2])
            vertices = np.fromfile(file, np.dtype([("p", "<f4", 3), ("c", "u1", 3)]), counts["vertex"])["p"]
            faces = np.fromfile(file, np.dtype([("n", "u1"), ("i", "<i4", 3)]), counts["face"])["i"] + first
        out.write(("v %.9g %.9g %.9g\n" * len(vertices)) % tuple(vertices.ravel().tolist()))
        out.write(("f %d %d %d\n" * len(faces)) % tuple(faces.ravel().tolist()))
        first += len(vertices)
