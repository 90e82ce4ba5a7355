# SPDX-License-Identifier: GPL-3.0-or-later
"""The papers' figures, made again from Verglas' own renders: ./verglas figures.

A module makes a figure or a family of figures; each is a function that takes a Studio, which has the scenes
and their truths, and returns a Figure, which has picture, numbers and caption."""
