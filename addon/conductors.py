# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals under a clear layer: what they reflect."""

import numpy as np

INDICES = {
    'ALUMINIUM': ((1.657, 0.880, 0.521), (9.224, 6.270, 4.837)),
    'CHROMIUM': ((3.106, 3.181, 2.323), (3.331, 3.330, 3.135)),
    'COPPER': ((0.200, 0.924, 1.102), (3.912, 2.452, 2.142)),
    'GOLD': ((0.183, 0.421, 1.373), (3.424, 2.346, 1.770)),
    'IRON': ((2.911, 2.950, 2.585), (3.089, 2.932, 2.767)),
    'SILVER': ((0.159, 0.145, 0.135), (3.929, 3.190, 2.381)),
    'TITANIUM': ((2.741, 2.542, 2.267), (3.814, 3.435, 3.039)),
}
"""Complex index of refraction, n and k, at 650, 550 and 450 nm."""


def reflectance(metal: str, ior: float) -> tuple[np.ndarray, np.ndarray]:
    """(3,) at straight incidence, and (3,) by which Schlick's reflectance from there on is multiplied at 82
    degrees (F82), in a medium of this index of refraction."""
    n, k = (np.array(part) / ior for part in INDICES[metal])
    straight = _fresnel(n, k, 1.0)
    cosine = 1.0 / 7.0
    schlick = straight + (1.0 - straight) * (1.0 - cosine) ** 5
    return straight, _fresnel(n, k, cosine) / schlick


def _fresnel(n: np.ndarray, k: np.ndarray, cosine: float) -> np.ndarray:
    """Of a conductor, for unpolarised light."""
    sine = np.sqrt(1.0 - cosine ** 2)
    index = n + 1j * k
    behind = np.sqrt(index ** 2 - sine ** 2)
    s = (cosine - behind) / (cosine + behind)
    p = (index ** 2 * cosine - behind) / (index ** 2 * cosine + behind)
    return 0.5 * (np.abs(s) ** 2 + np.abs(p) ** 2)
