# SPDX-License-Identifier: GPL-3.0-or-later
r"""Runs pytest inside Blender, with the installed add-on enabled:

    blender --background --factory-startup --python-exit-code 1 --python tests/blender/run_pytest.py -- \
        [ARGUMENT...]

--all runs the slow tests too; everything else goes to pytest, with paths relative to this folder.
"""

import os
import sys

import addon_utils
import pytest

if addon_utils.enable("verglas") is None:
    sys.exit("The add-on 'verglas' isn't installed in this Blender, or can't be enabled.")

os.chdir(os.path.dirname(os.path.abspath(__file__)))
arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
status = pytest.main(["-p", "no:cacheprovider", *arguments])
sys.stdout.flush()
sys.exit(int(status))
