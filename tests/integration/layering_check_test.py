#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants includes that break the rules, and some that do not, and sees what layering_check.py says."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).with_name("layering_check.py")

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
    ("service/app/run.cc", '#include "gst-plugins/homography_meta.h"'),
    ("service/app/run.cc", '#include "replay/format/sequence.h"'),
    ("gst-plugins/whregister.cc", '#include "service/app/run.h"'),
    ("gst-plugins/whregister.cc", '#include "gpu-kernels/warp/warp.h"'),
    ("gst-plugins/whregister.cc", '#include "replay/format/sequence.h"'),
    ("replay/render/render.cc", '#include "gst-plugins/homography_meta.h"'),
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
    ("replay/render/render.cc", '#include "gpu-kernels/backend.h"'),
    ("tests/gst-plugins/whregister_test.cc", '#include "gst-plugins/homography_meta.h"'),
]


def run_on(files):
    """Runs the check on a tree of (path, text); returns (exit status, what it printed)."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files:
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(f"// first line\n{text}\n", encoding="utf-8")
        done = subprocess.run(
            [sys.executable, CHECK, folder], capture_output=True, text=True, check=False
        )
        return done.returncode, done.stdout


class LayeringCheck(unittest.TestCase):
    def test_each_forbidden_include_is_found(self):
        for path, line in FORBIDDEN:
            with self.subTest(path=path, line=line):
                status, output = run_on([*ALLOWED[:1], (path, line)])
                self.assertEqual(status, 1, output)
                self.assertIn(f"{path}:2: ", output)
                self.assertIn("1 break a rule", output)

    def test_allowed_includes_pass(self):
        for path, line in ALLOWED:
            with self.subTest(path=path, line=line):
                status, output = run_on([("gpu-kernels/other.h", "#include <vector>"), (path, line)])
                self.assertEqual(status, 0, output)

    def test_all_faults_are_listed(self):
        files = [
            ("service/vision/a.cc", "#include <gst/gst.h>\n#include <dds/dds.h>"),
            ("replay/b.cc", '#include "gst-plugins/c.h"'),
        ]
        status, output = run_on(files)
        self.assertEqual(status, 1)
        self.assertIn("service/vision/a.cc:2: gst/gst.h", output)
        self.assertIn("service/vision/a.cc:3: dds/dds.h", output)
        self.assertIn("replay/b.cc:2: gst-plugins/c.h", output)
        self.assertIn("3 includes read, 3 break a rule", output)

    def test_a_tree_without_includes_is_a_mistake(self):
        status, output = run_on([("service/vision/a.cc", "int x;")])
        self.assertEqual(status, 1)
        self.assertIn("is this the repository's root?", output)


if __name__ == "__main__":
    unittest.main()
