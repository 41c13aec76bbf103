#!/usr/bin/env python3
"""Makes a wheel of the module and the shared library: packaging/wheel.py LIBRARY VERSION FOLDER; prints its path.

py3-none-PLATFORM, the same bytes for the same input. Without a network; standard library only."""
import base64
import hashlib
import sys
import sysconfig
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SUMMARY = "Moving and curving of meshes without inverted elements, certified"


def main(library, version, folder):
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    info, tag = f"almesh-{version}.dist-info", f"py3-none-{platform}"
    metadata = f"Metadata-Version: 2.1\nName: almesh\nVersion: {version}\nSummary: {SUMMARY}\nLicense: MIT\n" \
               "Requires-Python: >=3.7\nProvides-Extra: numpy\nRequires-Dist: numpy; extra == 'numpy'\n" \
               "Description-Content-Type: text/markdown\n\n" + (ROOT / "README.md").read_text()
    files = {"almesh.py": (ROOT / "src/almesh.py").read_bytes(),
             "almesh.libs/libalmesh.so.0": Path(library).read_bytes(),
             f"{info}/LICENSE": (ROOT / "LICENSE").read_bytes(),
             f"{info}/METADATA": metadata.encode(),
             f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: almesh\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()}
    record = "".join(f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},"
                     f"{len(data)}\n" for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    path = Path(folder) / f"almesh-{version}-{tag}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
    print(path)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
