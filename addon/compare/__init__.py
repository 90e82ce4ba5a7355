# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripted comparisons: renders a .blend by several methods, measures how far each is from the truth and
what it costs, and reports it. It runs inside Blender, without a display."""
