# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a picture is from another, over the pixels of the object.

Pictures are (H, W, 3), scene-linear; masks (H, W) bool with at least one pixel set. In every function `a` is
the picture that is judged and `b` the truth.
"""

import importlib

import numpy as np

RELATIVE_FLOOR = 0.01
"""Added to the squared truth in relmse, so that dark pixels don't decide it."""


def relmse(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float:
    """Relative mean squared error: mean of (a - b)^2 / (b^2 + 0.01)."""
    a, b = _inside(a, b, mask)
    return float(np.mean((a - b) ** 2 / (b ** 2 + RELATIVE_FLOOR)))


def relmse_net(a: np.ndarray, halves: tuple[np.ndarray, np.ndarray], mask: np.ndarray) -> float:
    """relmse against the mean of two independent truths, without the part that is the truths' own noise:
    their errors are independent, so in the product of the two differences they cancel on average (in the
    denominator they don't, which matters little). Slightly negative for some a that is as exact as they."""
    first, second = (_inside(a, half, mask)[1] for half in halves)
    a = a[mask].astype(np.float64)
    return float(np.mean((a - first) * (a - second) / ((0.5 * (first + second)) ** 2 + RELATIVE_FLOOR)))


def noise(halves: tuple[np.ndarray, np.ndarray], mask: np.ndarray) -> float:
    """relmse that two means of such halves, each of its own seeds, would have to each other: half of that
    between the halves, as a mean of two has half the variance of one."""
    return 0.5 * relmse(*halves, mask)


def rmse(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float:
    """Root mean squared error, in units of radiance."""
    a, b = _inside(a, b, mask)
    return float(np.sqrt(np.mean((a - b) ** 2)))


def bias(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float | None:
    """Mean of a - b as a share of the mean of b; None where the truth is black."""
    a, b = _inside(a, b, mask)
    return float(np.mean(a - b) / np.mean(b)) if b.any() else None


def psnr(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float | None:
    """Peak signal-to-noise ratio of the display pictures in dB, for a peak of 1; None where they're equal."""
    difference = rmse(display(a), display(b), mask)
    return float(-20.0 * np.log10(difference)) if difference > 0.0 else None


def ssim(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float | None:
    """Mean structural similarity of the display pictures (Wang et al. 2004, Gaussian window of sigma 1.5),
    1 for equal ones. None without scikit-image, and for pictures smaller than its window of 11 pixels."""
    try:
        from skimage.metrics import structural_similarity
    except ImportError:
        return None
    if min(mask.shape) < 11:
        return None
    _, similarity = structural_similarity(
        display(a), display(b), data_range=1.0, channel_axis=-1, full=True,
        gaussian_weights=True, sigma=1.5, use_sample_covariance=False)
    return float(similarity[mask].mean())


def flip(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float | None:
    """Mean FLIP difference of the display pictures (Andersson et al. 2020), 0 for equal ones; None where
    their module, flip_evaluator, can't be imported."""
    try:
        evaluator = importlib.import_module("flip_evaluator")
    except ImportError:
        return None
    pictures = (np.ascontiguousarray(display(picture)[::-1], np.float32) for picture in (b, a))
    differences, _, _ = evaluator.evaluate(*pictures, "LDR", applyMagma=False)
    return float(differences[::-1][mask].mean())


def display(picture: np.ndarray) -> np.ndarray:
    """Scene-linear to display values 0 … 1 by the curve of sRGB (IEC 61966-2-1), clipped."""
    linear = np.clip(picture, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)


ALL = {"relmse": relmse, "rmse": rmse, "psnr": psnr, "ssim": ssim, "flip": flip, "bias": bias}
"""Every metric of a report by its key."""


def measure(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> dict[str, float | None]:
    """All metrics by key; None where one can't be had."""
    return {key: metric(a, b, mask) for key, metric in ALL.items()}


def _inside(a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 3) each, in double precision."""
    return a[mask].astype(np.float64), b[mask].astype(np.float64)
