"""Fascia: anatomical face rigs for any head, simulated in real time.

    import fascia
    rig = fascia.build("head.obj", "rig.glb")        # runs the fascia tool
    asset = fascia.load("rig.glb")
    face = fascia.Face(asset)
    face.set("arkit:mouthSmileLeft", 0.8)
    face.pose()
    positions = face.positions(0)                     # a view of n x 3 floats, in the file's axes and units

    live = fascia.Fit(asset, "ibug68")                # muscles from a stream of 68 landmarks
    face.values[:] = live.push(points)["values"]

Arrays that are views belong to the face or asset, which they keep alive; they change with each pose or step.
Functions that can fail raise fascia.Error.
"""
import json
import os
import shutil
import subprocess

from ._runtime import Asset, Curves, Error, Face, Fit, version

__all__ = ["Asset", "Curves", "Error", "Face", "Fit", "build", "fit", "load", "load_curves", "run", "version"]
__version__ = version()


def load(path):
    """Loads a rig from a .glb file (a path or its bytes) as an Asset."""
    return Asset.from_bytes(_bytes(path))


def load_curves(path, frames_per_second=0.0):
    """Loads named values over time from a CSV, JSON or glTF file (a path or its bytes)."""
    return Curves.from_bytes(_bytes(path), frames_per_second)


def build(head, rig, **options):
    """Builds a rig of a head mesh with the fascia tool and returns its report (see `fascia build --json`).

    Options are the command's: build("head.obj", "rig.glb", detail="low", landmarks="points.json").
    """
    return run("build", head, "-o", rig, **options)


def fit(rig, target, to, **options):
    """Fits activations to a target mesh or sequence with the fascia tool and returns its report."""
    return run("fit", rig, target=target, o=to, **options)


def run(command, *arguments, **options):
    """Runs a command of the fascia tool with --json and returns what it prints.

    The tool is found by the environment variable FASCIA, or on the path. Raises Error with the tool's own message.
    """
    tool = os.environ.get("FASCIA") or shutil.which("fascia")
    if not tool:
        raise Error("the fascia tool is not on the path; set FASCIA to where it is")
    words = [tool, command, *map(os.fspath, arguments), "--json"]
    for name, value in options.items():
        flag = ("-" if len(name) == 1 else "--") + name.replace("_", "-")
        if value is True:
            words.append(flag)
        elif value is not None and value is not False:
            words += [flag, value if isinstance(value, str) else os.fspath(value) if hasattr(value, "__fspath__") else str(value)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4):
        raise Error(done.stderr.strip() or f"{command} ended with code {done.returncode}")
    return json.loads(done.stdout) if done.stdout.strip() else {}


def _bytes(path):
    if isinstance(path, (bytes, bytearray, memoryview)):
        return bytes(path)
    with open(path, "rb") as file:
        return file.read()
