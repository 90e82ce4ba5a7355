# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes pictures, by OpenImageIO. In arrays row 0 is at the bottom, in files at the top."""

from pathlib import Path

import numpy as np

from ..faults import Fault


def read_exr(path: Path) -> np.ndarray:
    """(H, W, 3) float32. Raises Fault."""
    oiio = _oiio()
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise Fault(f"'{path}' can't be read: {oiio.geterror()}.")
    pixels = file.read_image(0, 0, 0, 3, "float")
    file.close()
    return np.ascontiguousarray(pixels[::-1])


def write_exr(path: Path, pixels: np.ndarray) -> None:
    """pixels: (H, W, 3), written as float32. Raises Fault."""
    _write(path, pixels.astype(np.float32), "float")


def write_png(path: Path, pixels: np.ndarray) -> None:
    """pixels: (H, W, 3) display values 0 … 1, written in 8 bits. Raises Fault."""
    _write(path, np.rint(255.0 * np.clip(pixels, 0.0, 1.0)).astype(np.uint8), "uint8")


def _write(path: Path, pixels: np.ndarray, kind: str) -> None:
    oiio = _oiio()
    height, width, channels = pixels.shape
    file = oiio.ImageOutput.create(str(path))
    if not (file and file.open(str(path), oiio.ImageSpec(width, height, channels, kind))
            and file.write_image(np.ascontiguousarray(pixels[::-1])) and file.close()):
        raise Fault(f"'{path}' can't be written: {file.geterror() if file else oiio.geterror()}.")


def _oiio():
    try:
        import OpenImageIO
    except ImportError as error:
        raise Fault("Comparisons need OpenImageIO's Python module (on Debian: python3-openimageio), "
                    f"which this Blender's Python doesn't find: {error}.") from error
    return OpenImageIO
