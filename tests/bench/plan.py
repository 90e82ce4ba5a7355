# SPDX-License-Identifier: GPL-3.0-or-later
"""How much is measured."""

from dataclasses import dataclass

Size = tuple[int, int]
"""Width and height of a picture in pixels."""


@dataclass(frozen=True)
class Plan:
    most_frames: int
    least_frames: int
    seconds: float
    """When this time is over, no more frames begin than the least of a case."""
    model_sizes: tuple[Size, ...]
    model_limit: int | None
    """How many of the models are measured; None for all."""
    pixel_sizes: tuple[Size, ...]
    ball_edges: tuple[int, ...]
    """For cost against triangles: squares along the edges of cubes, drawn to balls of 12 n^2 triangles."""
    moving_edge: int
    """The same of the ball that moves and is deformed."""
    ndfs: tuple[str, ...]
    """whose tables are built and loaded"""
    map_widths: tuple[int, ...]
    engine_size: Size
    reference_samples: int
    cycles_samples: tuple[int, int]
    """A sample's time is the difference of two renders, by that of their samples."""
    with_eevee: bool
    bounces: tuple[int, ...]
    """in a coating's layer, which are path traced"""
    bounce_samples: int
    bounce_seeds: int
    """pictures of so many samples, whose variance is their noise"""
    viewport_size: Size
    viewport_seconds: float
    """How long the view is turned."""
    viewport_changes: int
    """of the material, of whose times the median counts"""


FULL = Plan(
    most_frames=5, least_frames=3, seconds=1.5,
    model_sizes=((512, 512), (1920, 1080)), model_limit=None,
    pixel_sizes=((256, 256), (512, 512), (1024, 1024), (1920, 1080), (2560, 1440), (3840, 2160)),
    ball_edges=(9, 18, 37, 73, 146, 289, 577),  # 1k to 4M triangles, by fours
    moving_edge=289,  # 1M triangles
    ndfs=('BECKMANN', 'GGX', 'BLINN_PHONG'), map_widths=(1024, 2048, 4096),
    engine_size=(512, 512), reference_samples=32, cycles_samples=(4, 36), with_eevee=True,
    bounces=(1, 2, 3, 4), bounce_samples=4, bounce_seeds=4,
    viewport_size=(960, 540), viewport_seconds=5.0, viewport_changes=7)

QUICK = Plan(
    most_frames=1, least_frames=1, seconds=0.0,
    model_sizes=((64, 64), (96, 54)), model_limit=2,
    pixel_sizes=((32, 32), (128, 128)), ball_edges=(4, 16), moving_edge=4,
    ndfs=('BECKMANN',), map_widths=(64,),
    engine_size=(64, 64), reference_samples=2, cycles_samples=(1, 65), with_eevee=False,
    bounces=(1, 4), bounce_samples=1, bounce_seeds=2,
    viewport_size=(640, 432), viewport_seconds=1.0, viewport_changes=1)
"""Only to see that all works."""
