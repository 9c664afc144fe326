#!/usr/bin/env python3
"""Packs the built Python module as a wheel (PEP 427): the package, the extension and the runtime it needs."""
import argparse
import base64
import hashlib
import pathlib
import sysconfig
import zipfile


def tag():
    version = sysconfig.get_config_var("py_version_nodot")
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"cp{version}-cp{version}-{platform}"


def soname(library):
    """The name the module looks for: libfascia.so.0 of libfascia.so.0.1.0."""
    parts = library.name.split(".so.")
    return library.name if len(parts) == 1 else parts[0] + ".so." + parts[1].split(".")[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("package", "module", "library", "licence", "to"):
        parser.add_argument("--" + name, type=pathlib.Path, required=True)
    parser.add_argument("--version", required=True)
    given = parser.parse_args()
    info = f"fascia-{given.version}.dist-info"
    files = {f"fascia/{path.name}": path.read_bytes() for path in sorted(given.package.iterdir())
             if path.suffix in (".py", ".pyi") or path.name == "py.typed"}
    files[f"fascia/{given.module.name}"] = given.module.read_bytes()
    files[f"fascia/{soname(given.library)}"] = given.library.resolve().read_bytes()
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: fascia\nVersion: {given.version}\n"
        "Summary: Anatomical face rigs for any head, simulated in real time\nLicense: MIT\n"
        "Requires-Python: >=3.9\nRequires-Dist: numpy\n").encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: fascia\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    files[f"{info}/LICENSE"] = given.licence.read_bytes()
    record = "".join(
        f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()},{len(data)}\n"
        for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    given.to.mkdir(parents=True, exist_ok=True)
    wheel = given.to / f"fascia-{given.version}-{tag()}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same bytes whenever it is made
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    print(wheel)


if __name__ == "__main__":
    main()
