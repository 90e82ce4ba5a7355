# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the add-on, with the core built beside it, into the user's Blender and enables it.

    blender --background --python addon/cli/install_addon.py -- ADDON_FOLDER BUILD_FOLDER

Does nothing where the very same files are installed and enabled already. Folders are exchanged by renaming,
so that a Blender that runs meanwhile keeps the files that it has open.
"""

import filecmp
import shutil
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import addon_utils
import bpy

NAME = "verglas"
NOT_INSTALLED = shutil.ignore_patterns("__pycache__", "*.pyc", ".*")


def core_module(build):
    """The core's module that this Blender's Python can import."""
    for suffix in EXTENSION_SUFFIXES:
        module = build / f"verglas_core{suffix}"
        if module.is_file():
            return module
    version = ".".join(map(str, sys.version_info[:2]))
    sys.exit(f"The core in {build} was built for another Python than this Blender's, {version} "
             f"({bpy.app.binary_path}); set BLENDER to the path of a Blender that uses /usr/bin/python3.")


def same_files(left, right):
    def files(folder):
        found = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
        return {path for path in found if "__pycache__" not in path.parts}

    if right.is_symlink() or not right.is_dir() or files(left) != files(right):
        return False
    return all(filecmp.cmp(left / f, right / f, shallow=False) for f in files(left))


def remove(path):
    if path.is_symlink() or path.is_file():
        path.unlink()
    elif path.exists():
        shutil.rmtree(path)


def install(addon, module, addons):
    """Returns whether anything had to be copied."""
    target, new, old = addons / NAME, addons / f".{NAME}.new", addons / f".{NAME}.old"
    remove(new)
    remove(old)
    shutil.copytree(addon, new, ignore=NOT_INSTALLED)
    shutil.copy2(module, new)
    if same_files(new, target):
        remove(new)
        return False
    if target.exists() or target.is_symlink():
        target.rename(old)
    new.rename(target)
    remove(old)
    return True


def main():
    addon, build = (Path(a) for a in sys.argv[sys.argv.index("--") + 1:])
    addons = Path(bpy.utils.user_resource('SCRIPTS', path="addons", create=True))
    copied = install(addon, core_module(build), addons)
    if NAME not in bpy.context.preferences.addons:
        bpy.utils.refresh_script_paths()  # the folder may be new
        if addon_utils.enable(NAME, default_set=True) is None:
            sys.exit("Blender could not enable the add-on.")
        bpy.ops.wm.save_userpref()
        print(f"verglas: installed and enabled the add-on in {addons / NAME}")
    else:
        print(f"verglas: {'brought up to date' if copied else 'up to date'}: {addons / NAME}")


main()
