# SPDX-License-Identifier: Apache-2.0
"""Renders a scene package in Cycles: blender -b --python render.py -- PACKAGE OUT.pfm [options]. Blender 3.4 and 4.3.

These properties are matched, so that the pictures agree up to noise:
  geometry   binary PLY as cyclorama-grotto --kind interior writes it: flat triangles, sRGB colours per vertex
  materials  Cycles' diffuse BSDF of roughness 0, which is Lambertian
  lamps      rectangles as area lights, calibrated by rendering one: the meaning of Blender's watts differs by version
  camera     perspective, as wide as --azimuth-deg; pixels are boxes
  paths      path length as Mitsuba and pbrt count it: edges from the eye to the light. 4 are three surfaces at most, two
             bounces of indirect light: Cycles' max_bounces = length - 2, --bounces = length - 2 of cyclorama-render
  off        clamping, light threshold, adaptive sampling, denoising; --defaults leaves the first two as Blender has them
The frame y up becomes Blender's z up: (x, y, z) is (x, -z, y) there.
"""
import argparse
import json
import math
import os
import resource
import sys
import tempfile

import bpy
import numpy as np

try:
    import tomllib
except ImportError:  # Debian 12 has Python 3.11; other systems may have an older one.
    import tomli as tomllib


def options():
    parser = argparse.ArgumentParser(prog="render.py")
    parser.add_argument("package")
    parser.add_argument("out")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--azimuth-deg", type=float, default=75.0)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--path-length", type=int, default=4)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--defaults", action="store_true")
    parser.add_argument("--json")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def read_ply(path):
    """Returns positions (n, 3), colours (n, 3) in 0..255 and triangles (m, 3)."""
    with open(path, "rb") as file:
        counts, fields, element = {}, {"vertex": [], "face": []}, None
        kinds = {"float": "<f4", "uchar": "u1"}
        for line in iter(lambda: file.readline().decode("ascii").split(), ["end_header"]):
            if line[0] == "format" and line[1] != "binary_little_endian":
                raise SystemExit(f"{path}: only little-endian binary PLY is read here")
            if line[0] == "element":
                element = line[1]
                counts[element] = int(line[2])
            elif line[0] == "property" and line[1] != "list":
                fields[element].append((line[2], kinds[line[1]]))
        vertices = np.fromfile(file, np.dtype(fields["vertex"]), counts["vertex"])
        faces = np.fromfile(file, np.dtype([("n", "u1"), ("i", "<i4", 3)]), counts["face"])
    positions = np.stack([vertices[k] for k in "xyz"], axis=1)
    colours = np.stack([vertices[k] for k in ("red", "green", "blue")], axis=1)
    return positions, colours, faces["i"]


def linear(codes):
    s = codes / 255.0
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def add_material():
    material = bpy.data.materials.new("matte")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    colour, diffuse, out = (nodes.new("ShaderNode" + kind) for kind in ("Attribute", "BsdfDiffuse", "OutputMaterial"))
    colour.attribute_name = "paint"
    diffuse.inputs["Roughness"].default_value = 0.0
    links.new(colour.outputs["Color"], diffuse.inputs["Color"])
    links.new(diffuse.outputs["BSDF"], out.inputs["Surface"])
    return material


def add_mesh(path, material):
    positions, colours, triangles = read_ply(path)
    mesh = bpy.data.meshes.new(os.path.basename(path))
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.stack([positions[:, 0], -positions[:, 2], positions[:, 1]], axis=1).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    if bpy.app.version < (4, 0):  # Newer versions derive it from the loops' starts.
        mesh.polygons.foreach_set("loop_total", np.full(len(triangles), 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.zeros(len(triangles), dtype=bool))
    paint = mesh.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    rgba = np.ones((len(positions), 4), dtype=np.float32)
    rgba[:, :3] = linear(colours)
    paint.data.foreach_set("color", rgba.ravel())
    mesh.update(calc_edges=True)
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(mesh.name, mesh))


def add_lamp(lamp):
    """Adds an area light of one watt. It shines along its own -z, which is downwards here."""
    if lamp["kind"] != "rectangle" or lamp.get("direction", [0, -1, 0]) != [0, -1, 0]:
        raise SystemExit("only rectangles that shine downwards are supported")
    light = bpy.data.lights.new(lamp.get("name", "lamp"), "AREA")
    light.shape = "RECTANGLE"
    light.size, light.size_y = lamp["size_m"]
    light.color = (1.0, 1.0, 1.0)
    light.energy = 1.0
    light.cycles.max_bounces = 1024
    thing = bpy.data.objects.new(light.name, light)
    thing.visible_camera = True
    x, y, z = lamp["position_m"]
    thing.location = (x, -z, y)
    bpy.context.scene.collection.objects.link(thing)
    return light


def add_camera(eye, heading_deg, azimuth_deg, size):
    camera = bpy.data.cameras.new("eye")
    camera.sensor_fit = "HORIZONTAL"
    camera.angle = math.radians(azimuth_deg)
    camera.clip_start, camera.clip_end = 1e-3, 1e4
    thing = bpy.data.objects.new("eye", camera)
    thing.location = (eye[0], -eye[2], eye[1])
    # A camera looks along its -z with y up; rotated upright, it looks along the scene's -z.
    thing.rotation_euler = (0.5 * math.pi, 0.0, -math.radians(heading_deg))
    scene = bpy.context.scene
    scene.collection.objects.link(thing)
    scene.camera = thing
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    return thing


def configure(wanted):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", wanted.threads
    scene.render.use_persistent_data = True  # Keeps data between pictures, so that a second one costs only its rays.
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Standard"
    scene.world = None
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.seed = wanted.seed
    cycles.max_bounces = cycles.diffuse_bounces = wanted.path_length - 2
    cycles.min_light_bounces = cycles.min_transparent_bounces = 0
    cycles.transparent_max_bounces = 64
    if not wanted.defaults:
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
        cycles.light_sampling_threshold = 0.0


def render(samples):
    """Returns the picture, bottom row first, and its cpu time."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        before = resource.getrusage(resource.RUSAGE_SELF)
        bpy.ops.render.render(write_still=True)
        after = resource.getrusage(resource.RUSAGE_SELF)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        width, height = image.size
        pixels = np.empty(width * height * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return pixels.reshape(height, width, 4)[:, :, :3], cpu


def calibrate(lamps, lights):
    """Renders each kind of lamp from below and sets its power so that it has the package's radiance."""
    scene = bpy.context.scene
    place, lamp = scene.camera, lamps[0]
    kept = place.location.copy(), place.rotation_euler.copy(), scene.render.resolution_x, scene.render.resolution_y
    x, y, z = lamp["position_m"]
    place.location = (x, -z, y - 0.02 * min(lamp["size_m"]))
    place.rotation_euler = (math.pi, 0.0, 0.0)
    scene.render.resolution_x, scene.render.resolution_y = 8, 8
    seen = float(render(1)[0][3:5, 3:5].mean())
    place.location, place.rotation_euler, scene.render.resolution_x, scene.render.resolution_y = kept
    for lamp, light in zip(lamps, lights):
        area = light.size * light.size_y
        radiance = lamp["luminance_nits"]
        light.color = [c / max(radiance) for c in radiance]
        light.energy = max(radiance) / seen * area / (lights[0].size * lights[0].size_y)
    return seen * math.pi * lights[0].size * lights[0].size_y


def main():
    wanted = options()
    with open(os.path.join(wanted.package, "scene.toml"), "rb") as file:
        package = tomllib.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    configure(wanted)
    material = add_material()
    for geometry in package["geometry"]:
        add_mesh(os.path.join(wanted.package, geometry["file"]), material)
    lights = [add_lamp(lamp) for lamp in package["lamp"]]
    size = tuple(int(n) for n in wanted.size.split("x"))
    add_camera(package["start"]["eye_m"], package["start"]["heading_deg"], wanted.azimuth_deg, size)
    watt = calibrate(package["lamp"], lights)
    render(1)  # Builds the BVH and warms the data that stay between pictures.
    pixels, cpu = render(wanted.samples)
    exposed = (pixels * package.get("exposure", 1.0)).astype("<f4")
    with open(wanted.out, "wb") as file:
        file.write(f"PF\n{size[0]} {size[1]}\n-1.0\n".encode("ascii") + exposed.tobytes())
    figures = {"version": bpy.app.version_string, "cpu_s": cpu, "mean": [float(c) for c in pixels.mean(axis=(0, 1))],
               "radiance_pi_area_of_one_watt": watt}
    print(json.dumps(figures))
    if wanted.json:
        with open(wanted.json, "w") as file:
            json.dump(figures, file)


main()
