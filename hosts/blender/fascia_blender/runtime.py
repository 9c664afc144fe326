"""What the add-on needs of Fascia's runtime, through ctypes: no build for Blender's own Python."""
import ctypes
import ctypes.util
import os

import numpy as np

_spaces = {"mesh": 0, "input": 1, "metres": 2}
_uint, _pointer = ctypes.c_uint32, ctypes.c_void_p


class Error(RuntimeError):
    pass


class _Info(ctypes.Structure):
    _fields_ = [(name, _uint) for name in ("struct_size", "levels", "meshes", "channels", "sets", "muscles")] + [
        ("input_to_metres", ctypes.c_float * 16)]


class _Mesh(ctypes.Structure):
    _fields_ = [(name, _uint) for name in ("struct_size", "mesh", "primitive", "vertices", "triangles", "reserved")] + [
        ("name", ctypes.c_char_p), ("part", ctypes.c_char_p), ("indices", _pointer)]


class _Channels(ctypes.Structure):
    _fields_ = [("struct_size", _uint), ("count", _uint)] + [
        (name, ctypes.POINTER(ctypes.c_char_p)) for name in ("names", "groups", "units")] + [
        (name, ctypes.POINTER(ctypes.c_float)) for name in ("minimum", "maximum", "rest")]


class _Set(ctypes.Structure):
    _fields_ = [("struct_size", _uint), ("count", _uint), ("name", ctypes.c_char_p),
                ("members", ctypes.POINTER(ctypes.c_char_p))]


class _Options(ctypes.Structure):
    _fields_ = [("struct_size", _uint)] + [(name, ctypes.c_int32) for name in ("space", "solver", "level", "iterations")]


class _Vectors(ctypes.Structure):
    _fields_ = [(name, _uint) for name in ("struct_size", "count", "stride", "reserved")] + [
        ("data", ctypes.POINTER(ctypes.c_float))]


def _library():
    """The runtime: FASCIA_LIBRARY, beside the add-on, or the system's."""
    here = os.path.dirname(__file__)
    names = [os.environ.get("FASCIA_LIBRARY"), *(os.path.join(here, name) for name in
                                                 ("libfascia.so", "fascia.dll", "libfascia.dylib")), "libfascia.so.0"]
    for name in names:
        if name and (os.path.exists(name) or os.sep not in name):
            try:
                library = ctypes.CDLL(name)
            except OSError:
                continue
            library.fascia_last_message.restype = ctypes.c_char_p
            return library
    raise Error("Fascia's library is not there: install libfascia0, or set FASCIA_LIBRARY to libfascia.so")


_loaded = None


def _call(name, *arguments):
    global _loaded
    _loaded = _loaded or _library()
    result = getattr(_loaded, name)(*arguments)
    if result not in (0, 7):  # 7: put back to rest, goes on
        raise Error(_loaded.fascia_last_message().decode())


def _filled(structure, name, *arguments):
    value = structure()
    value.struct_size = ctypes.sizeof(structure)
    _call(name, *arguments, ctypes.byref(value))
    return value


class Asset:
    def __init__(self, rig):
        self.handle = _pointer()
        _call("fascia_asset_load", rig, ctypes.c_size_t(len(rig)), ctypes.byref(self.handle))
        info = _filled(_Info, "fascia_asset_get_info", self.handle)
        meshes = [_filled(_Mesh, "fascia_asset_get_mesh", self.handle, i) for i in range(info.meshes)]
        self.meshes = [{"name": mesh.name.decode(), "part": mesh.part.decode(), "vertices": mesh.vertices} for mesh in meshes]
        channels = _filled(_Channels, "fascia_asset_get_channels", self.handle)
        self.channels = [{"name": channels.names[i].decode(), "group": channels.groups[i].decode(),
                          "unit": channels.units[i].decode(), "minimum": channels.minimum[i],
                          "maximum": channels.maximum[i], "rest": channels.rest[i]}
                         for i in range(channels.count)]
        sets = [_filled(_Set, "fascia_asset_get_set", self.handle, i) for i in range(info.sets)]
        self.sets = {entry.name.decode(): [entry.members[m].decode() for m in range(entry.count)] for entry in sets}

    def __del__(self):
        if _loaded and self.handle:
            _loaded.fascia_asset_release(self.handle)


class Face:
    def __init__(self, asset, space="mesh", level=-1):
        self.asset, self.handle = asset, _pointer()
        options = _Options(ctypes.sizeof(_Options), _spaces[space], 0, level, 0)
        _call("fascia_face_create", asset.handle, ctypes.byref(options), ctypes.byref(self.handle))

    def __del__(self):
        if _loaded and self.handle:
            _loaded.fascia_face_release(self.handle)

    def set(self, name, value):
        _call("fascia_face_set", self.handle, name.encode(), ctypes.c_float(value))

    def clear(self):
        _call("fascia_face_clear", self.handle)

    def pose(self):
        _call("fascia_face_pose", self.handle)

    def step(self, seconds):
        _call("fascia_face_step", self.handle, ctypes.c_float(min(seconds, 1.0)))

    def positions(self, mesh):
        """A view of vertices x 3 floats that keeps up with the face."""
        vectors = _filled(_Vectors, "fascia_face_positions", self.handle, mesh)
        return np.ctypeslib.as_array(vectors.data, (vectors.count, 3))
