#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the links between the folders run one way.

Reads every #include of the tree and holds it against two tables: which folders of ours a folder may
include, and which third-party headers belong where. Prints one line for each include that breaks a
rule and exits with 1 if there is any.
"""

import argparse
import pathlib
import re
import sys

# For each folder, the folders (or headers) of ours that it may include beside itself. The longest
# entry that a file's path starts with is the one that counts.
MAY_INCLUDE = {
    "idl/": (),
    "gpu-kernels/": (),
    "service/options/": (),
    "service/vision/": ("service/options/", "gpu-kernels/"),
    "service/dds/": ("service/options/", "service/vision/types.h", "idl/"),
    "service/gstreamer/": ("service/vision/",),
    "service/app/": ("service/", "gpu-kernels/"),
    "gst-plugins/": (
        "service/options/",
        "service/vision/",
        "service/dds/",
        "service/gstreamer/",
        "gpu-kernels/backend.h",
        "gpu-kernels/image.h",
        "gpu-kernels/multiversion.h",  # a macro; nothing to link with
    ),
    "replay/": ("service/options/", "service/vision/", "service/gstreamer/", "gpu-kernels/"),
    "deploy/": (),
    # The operators can be built and tested alone, on a machine that has nothing but a GPU.
    "tests/gpu-kernels/": ("gpu-kernels/", "tests/support/"),
    "tests/": ("",),
}

# Third-party headers that only these folders may include.
BELONGS_TO = {
    "CL/": ("gpu-kernels/opencl/",),
    "fftw3.h": ("gpu-kernels/", "tests/gpu-kernels/"),
    "gst/": (
        "service/gstreamer/",
        "service/app/",
        "gst-plugins/",
        "replay/offline/",
        "replay/render/",
        "tests/",
    ),
    "dds/": ("service/dds/", "tests/"),
    "idl/": ("service/dds/", "tests/"),
    "CLI/": ("service/app/", "replay/", "tests/"),
    "nlohmann/": ("service/", "replay/", "tests/"),
    "spdlog/": (
        "service/dds/",
        "service/gstreamer/",
        "service/app/",
        "gst-plugins/",
        "replay/",
        "tests/",
    ),
    "opencv2/": ("service/vision/", "service/app/", "gst-plugins/", "replay/", "tests/"),
    "Eigen/": (
        "service/vision/",
        "service/dds/",
        "service/gstreamer/",
        "service/app/",
        "gst-plugins/",
        "replay/",
        "tests/",
    ),
}

# Nothing of the operators' may need these, tests included.
FOREIGN_TO_OPERATORS = ("Eigen/", "opencv2/", "spdlog/", "gst/", "dds/", "nlohmann/", "CLI/")

SOURCE_SUFFIXES = {".h", ".cc", ".c", ".cl"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


def folder_of(path):
    """The entry of MAY_INCLUDE that the path falls under, or None."""
    entries = [entry for entry in MAY_INCLUDE if path.startswith(entry)]
    return max(entries, key=len) if entries else None


def fault_of(path, header, quoted):
    """Why the file at `path` may not include `header`; None where it may."""
    folder = folder_of(path)
    if folder is None:
        return "lies in no folder of the house"
    if folder in ("gpu-kernels/", "tests/gpu-kernels/") and header.startswith(FOREIGN_TO_OPERATORS):
        return "operators need nothing but a compiler, OpenCL and FFTW3"
    for prefix, owners in BELONGS_TO.items():
        if header.startswith(prefix) and not path.startswith(owners):
            return f"{prefix} belongs to {', '.join(owners)}"
    if not quoted:
        return None
    if folder_of(header) is None:
        return "headers of ours are included from the repository's root"
    if not header.startswith((folder, *MAY_INCLUDE[folder])):
        allowed = ", ".join(MAY_INCLUDE[folder]) or "nothing of ours"
        return f"{folder} may include itself and {allowed}"
    return None


def sources_of(root):
    """Paths, relative to the root, of all sources in the folders of the house."""
    tops = {entry.split("/")[0] for entry in MAY_INCLUDE}
    for top in sorted(tops):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCE_SUFFIXES and path.is_file():
                yield path.relative_to(root)


def check(root):
    """Returns (number of includes read, list of "file:line: header: reason")."""
    count = 0
    faults = []
    for path in sources_of(root):
        lines = (root / path).read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines, start=1):
            match = INCLUDE.match(line)
            if not match:
                continue
            count += 1
            quoted = match[1] is not None
            header = match[1] or match[2]
            fault = fault_of(path.as_posix(), header, quoted)
            if fault:
                faults.append(f"{path.as_posix()}:{number}: {header}: {fault}")
    return count, faults


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=pathlib.Path, help="the repository's root")
    count, faults = check(parser.parse_args(arguments).root)
    for fault in faults:
        print(fault)
    print(f"{count} includes read, {len(faults)} break a rule")
    if count == 0:
        print("no include found: is this the repository's root?")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
