#!/usr/bin/env python3
"""Random people of a measured face model (ICT-FaceKit; Li et al., Learning formation of physically-based face
attributes, 2020), one PLY mesh each with eyes, teeth and lashes, and a manifest of them for `fascia batch`.

    random_people.py MODEL.npz FOLDER [--count 500] [--first-seed 1000] [--detail low]
    fascia batch FOLDER/people.jsonl -o RIGS --no-thumbnail && fascia batch report RIGS

person = base + sum of c_i id_i, c_i standard normal, cut at 2.2.
"""
import argparse
import json
import pathlib

import numpy


def write_ply(path, vertices, triangles):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
              "property float x\nproperty float y\nproperty float z\n"
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    faces = numpy.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--detail", default="low", choices=["low", "medium", "high"])
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    with numpy.load(given.model) as model:
        base, modes, scales = model["base"], model["ids"], model["si"]
        triangles = model["tri"]
    with open(given.folder / "people.jsonl", "w") as manifest:
        for seed in range(given.first_seed, given.first_seed + given.count):
            drawn = numpy.random.default_rng(seed).standard_normal(len(modes)).clip(-2.2, 2.2)
            vertices = base + numpy.tensordot(drawn * scales, modes.astype(float), axes=1)
            write_ply(given.folder / f"person_{seed}.ply", vertices, triangles)
            manifest.write(json.dumps({"head": f"person_{seed}.ply", "detail": given.detail}) + "\n")


if __name__ == "__main__":
    main()
