#!/usr/bin/env python3
"""Renders tests/reference/room.obj with Mitsuba 3 and writes tests/reference/mitsuba_room.csv.

Mean linear RGB of 8 x 8 regions of the picture, each with its standard error from independent
renders, for three ways to light and see the room. The test `mitsuba_sees_the_same_room`
(tests/oracles/mitsuba.rs) holds our estimates against the file; Mitsuba is not needed there.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python contrib/reference/mitsuba_room.py
"""

import csv
import os
import sys
import tempfile

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCE = os.path.join(HERE, "..", "..", "tests", "reference")
SIZE, REGIONS = 64, 8
RENDERS, SPP = 24, 64

# Longest path, as Mitsuba counts: 2 is light seen after one reflection.
VARIANTS = [("direct", 2, None), ("bounces", 4, None), ("lens", 2, (0.09, 4.58))]


def read_obj(path):
    """Vertices as lines, and the face lines of each material."""
    vertices, faces, current = [], {}, None
    for line in open(path):
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append(line)
        elif words[0] == "usemtl":
            current = faces.setdefault(words[1], [])
        elif words[0] == "f":
            current.append(line)
    return vertices, faces


def read_mtl(path):
    materials, current = {}, None
    for line in open(path):
        words = line.split()
        if words and words[0] == "newmtl":
            current = materials.setdefault(words[1], {})
        elif words:
            current[words[0]] = [float(x) for x in words[1:]]
    return materials


def rgb(value):
    return {"type": "rgb", "value": value}


def scene(folder, max_depth, lens):
    vertices, faces = read_obj(os.path.join(REFERENCE, "room.obj"))
    materials = read_mtl(os.path.join(REFERENCE, "room.mtl"))
    camera = {
        "type": "thinlens" if lens else "perspective",
        "fov": 38.0,
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at([0, 1, 4.2], [0, 0.95, 0], [0, 1, 0]),
        "sampler": {"type": "independent", "sample_count": SPP},
        "film": {
            "type": "hdrfilm",
            "width": SIZE,
            "height": SIZE,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
    }
    if lens:
        camera["aperture_radius"], camera["focus_distance"] = lens
    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": max_depth, "rr_depth": 100},
        "camera": camera,
    }
    for name, lines in faces.items():
        path = os.path.join(folder, name + ".obj")
        with open(path, "w") as out:
            out.writelines(vertices + lines)
        diffuse = {"type": "diffuse", "reflectance": rgb(materials[name]["Kd"])}
        shape = {
            "type": "obj",
            "filename": path,
            "face_normals": True,
            "bsdf": {"type": "twosided", "bsdf": diffuse},
        }
        if "Ke" in materials[name]:
            shape["emitter"] = {"type": "area", "radiance": rgb(materials[name]["Ke"])}
        parts[name] = shape
    return mi.load_dict(parts)


def main():
    rows = []
    for variant, max_depth, lens in VARIANTS:
        with tempfile.TemporaryDirectory() as folder:
            room = scene(folder, max_depth, lens)
        means = []
        for seed in range(RENDERS):
            picture = np.array(mi.render(room, spp=SPP, seed=1996 + seed), dtype=np.float64)
            side = SIZE // REGIONS
            blocks = picture.reshape(REGIONS, side, REGIONS, side, 3)
            means.append(blocks.mean(axis=(1, 3)))
            if len(sys.argv) > 1 and seed == 0:
                mi.util.write_bitmap(os.path.join(sys.argv[1], variant + ".png"), picture)
        means = np.array(means)
        value = means.mean(axis=0)
        error = means.std(axis=0, ddof=1) / np.sqrt(RENDERS)
        for row in range(REGIONS):
            for column in range(REGIONS):
                numbers = np.concatenate([value[row, column], error[row, column]])
                rows.append([variant, column, row] + [f"{x:.9g}" for x in numbers])
    with open(os.path.join(REFERENCE, "mitsuba_room.csv"), "w", newline="") as out:
        out.write(
            f"# Mitsuba {mi.__version__}, {mi.variant()}: {RENDERS} renders of {SIZE} x {SIZE} "
            f"pixels, {SPP} samples each, box filter\n"
        )
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["variant", "column", "row", "r", "g", "b", "r_se", "g_se", "b_se"])
        writer.writerows(rows)


if __name__ == "__main__":
    main()
