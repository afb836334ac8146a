#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants includes that break the rules, and some that do not, and sees what layering_check.py says."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # nothing is to be left in the source tree
import layering_check  # noqa: E402  (beside this file)

FORBIDDEN = [
    ("gpu-kernels/warp/warp_cpu.cc", '#include "service/vision/types.h"'),
    ("gpu-kernels/warp/warp_cpu.cc", "#include <Eigen/Core>"),
    ("gpu-kernels/warp/warp_opencl.cc", "#include <CL/cl.h>"),
    ("gpu-kernels/warp/warp.cl", '#include "replay/render/noise.h"'),
    ("tests/gpu-kernels/warp_test.cc", '#include "service/vision/types.h"'),
    ("tests/gpu-kernels/warp_test.cc", "#include <CL/cl.h>"),
    ("service/options/option.h", '#include "service/vision/types.h"'),
    ("service/vision/motion.cc", '#include "service/dds/publisher.h"'),
    ("service/vision/motion.cc", '#include "service/app/run.h"'),
    ("service/vision/motion.cc", "#include <dds/dds.h>"),
    ("service/vision/motion.cc", "#include <gst/gst.h>"),
    ("service/vision/motion.cc", "  #  include  <gst/gst.h>"),
    ("service/vision/motion.cc", '#include "idl/detections.h"'),
    ("service/vision/motion.cc", '#include "motion.h"'),
    ("service/vision/motion.cc", '#include "../options/option.h"'),
    ("service/dds/publisher.cc", '#include "service/vision/motion.h"'),
    ("service/dds/publisher.cc", '#include "gpu-kernels/backend.h"'),
    ("service/gstreamer/start.cc", '#include "service/app/run.h"'),
    ("service/gstreamer/start.cc", "#include <dds/dds.h>"),
    ("service/app/run.cc", '#include "gst-plugins/luma.h"'),
    ("service/app/run.cc", '#include "replay/format/sequence.h"'),
    ("gst-plugins/whregister.cc", '#include "service/app/run.h"'),
    ("gst-plugins/whregister.cc", '#include "gpu-kernels/warp/warp.h"'),
    ("gst-plugins/whregister.cc", '#include "replay/format/sequence.h"'),
    ("replay/render/render.cc", '#include "gst-plugins/luma.h"'),
    ("replay/render/render.cc", '#include "service/dds/publisher.h"'),
    ("deploy/examples/watch.cc", '#include "service/dds/subscriber.h"'),
]

ALLOWED = [
    ("gpu-kernels/warp/warp_cpu.cc", '#include "gpu-kernels/image.h"'),
    ("gpu-kernels/opencl/api.h", "#include <CL/cl.h>"),
    ("service/vision/motion.cc", '#include "gpu-kernels/warp/warp.h"'),
    ("service/vision/motion.cc", "#include <vector>"),
    ("service/vision/motion.cc", '// #include "service/dds/publisher.h"'),
    ("service/dds/conversion.cc", '#include "idl/detections.h"'),
    ("service/dds/conversion.cc", '#include "service/vision/types.h"'),
    ("service/app/run.cc", '#include "service/dds/subscriber.h"'),
    ("service/app/run.cc", "#include <gst/gst.h>"),
    ("gst-plugins/whregister.cc", '#include "gpu-kernels/backend.h"'),
    ("service/gstreamer/start.cc", "#include <gst/gst.h>"),
    ("service/app/run.cc", '#include "service/gstreamer/start.h"'),
    ("replay/render/render.cc", '#include "gpu-kernels/backend.h"'),
    ("service/gstreamer/homography_meta.h", '#include "service/vision/types.h"'),
    ("gst-plugins/whregister.cc", '#include "service/gstreamer/homography_meta.h"'),
    ("replay/offline/detection.cc", '#include "service/gstreamer/start.h"'),
    ("tests/gst-plugins/whregister_test.cc", '#include "gst-plugins/luma.h"'),
]


def run_on(files):
    """Runs the check on a tree of (path, text); returns (number of includes, faults)."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files:
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(f"// first line\n{text}\n", encoding="utf-8")
        return layering_check.check(pathlib.Path(folder))


class LayeringCheck(unittest.TestCase):
    def test_each_forbidden_include_is_found(self):
        for path, line in FORBIDDEN:
            with self.subTest(path=path, line=line):
                count, faults = run_on([ALLOWED[0], (path, line)])
                self.assertEqual(len(faults), 1, faults)
                self.assertTrue(faults[0].startswith(f"{path}:2: "), faults)

    def test_allowed_includes_pass(self):
        for path, line in ALLOWED:
            with self.subTest(path=path, line=line):
                count, faults = run_on([("gpu-kernels/other.h", "#include <vector>"), (path, line)])
                self.assertEqual(faults, [])
                self.assertEqual(count, 1 if line.startswith("//") else 2)

    def test_all_faults_of_a_tree_are_listed(self):
        _, faults = run_on(
            [
                ("service/vision/a.cc", "#include <gst/gst.h>\n#include <dds/dds.h>"),
                ("replay/b.cc", '#include "gst-plugins/c.h"'),
            ]
        )
        places = [fault.rsplit(": ", 1)[0] for fault in faults]
        self.assertEqual(
            places,
            [
                "replay/b.cc:2: gst-plugins/c.h",
                "service/vision/a.cc:2: gst/gst.h",
                "service/vision/a.cc:3: dds/dds.h",
            ],
        )


class Program(unittest.TestCase):
    def status_on(self, text):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "service/vision/a.cc")
            file.parent.mkdir(parents=True)
            file.write_text(text, encoding="utf-8")
            with contextlib.redirect_stdout(io.StringIO()):
                return layering_check.main([folder])

    def test_exit_status(self):
        self.assertEqual(self.status_on("#include <vector>\n"), 0)
        self.assertEqual(self.status_on("#include <gst/gst.h>\n"), 1)

    def test_a_tree_without_includes_is_a_mistake(self):
        self.assertEqual(self.status_on("int x;\n"), 1)


if __name__ == "__main__":
    unittest.main()
