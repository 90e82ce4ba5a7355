# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender materials to core materials, with the meaning that Cycles gives to the standard nodes."""

from collections.abc import Hashable

import bpy
import numpy as np

from .. import compat, conductors
from .. import verglas_core as core
from ..faults import Warn
from . import expressions, images, nodes
from .evaluation import expression_of, expression_of_image
from .relief import Relief, relief_of

NDF_OF_DISTRIBUTION = {
    'BECKMANN': 'BECKMANN',
    'GGX': 'GGX',
    'MULTI_GGX': 'GGX',
    'SHARP': 'BECKMANN',
}
"""The core's distribution for a node's; SHARP has no roughness, so that either would do."""

COLORS = ("Base Color", "Color")
"""Names of shader nodes' own colour."""

IOR_RANGE = (1.0 / 3.0, 3.0)
"""The indices of refraction that the core has tables for."""


class Glass(core.Material):
    """The core's material, whose roughness and normals may yet vary over the surface."""

    roughness_map: expressions.Expression | None = None
    """in place of roughness where it varies"""
    inner_roughness_map: expressions.Expression | None = None
    """in place of that of its layer where it varies"""
    relief = Relief()
    """what bends the normals"""
    bake_resolution = 1024
    """texels along the side of a texture that stands for it, where one has to be baked"""

    @property
    def painting_key(self) -> Hashable:
        """Equal where the same textures stand for what varies; a value's change leaves it as it is."""
        normals, heights = self.relief
        return (self.roughness_map and self.roughness_map.key,
                self.inner_roughness_map and self.inner_roughness_map.key,
                normals and (normals.colors.key, normals.space, normals.uv_map),
                heights and heights.heights.key, self.bake_resolution)


def default_glass(name: str) -> Glass:
    """What an object without a readable material is made of."""
    glass = Glass(name)
    glass.roughness = 0.25
    glass.ior = 1.5
    glass.fresnel = True
    return glass


def base_color(material: bpy.types.Material) -> np.ndarray:
    """(3,) of its first shader node; what varies of it is left out. Without nodes that of Solid shading."""
    if compat.uses_nodes(material) and (output := nodes.output_node(material.node_tree)):
        for shader, groups in nodes.shader_nodes(nodes.Input(output.inputs["Surface"])):
            node = nodes.Node(shader, groups, "", lambda _: None)
            if node.input(*COLORS) is not None:
                return node.color(*COLORS)
    return np.array(material.diffuse_color[:3], np.float32)


def from_blender(material: bpy.types.Material, warn: Warn, check_images: bool = False) -> Glass | None:
    """None where the material has no glass in it. check_images: as images.picture's."""
    owner = f"Material '{material.name}'"
    if not compat.uses_nodes(material):
        warn(f"{owner} doesn't use nodes; it is rendered as glass of roughness 0.25.")
        glass = default_glass(material.name)
        _apply_panel(material, glass, warn, check_images, has_volume=False)
        return glass
    output = nodes.output_node(material.node_tree)
    glass = _surface(material, output, owner, warn, check_images) if output else None
    if glass is not None:
        has_volume = _volume(output, glass, owner, warn)
        _apply_panel(material, glass, warn, check_images, has_volume)
        _warn_of_displacement(output, owner, warn)
    return glass


def _surface(material: bpy.types.Material, output: bpy.types.Node, owner: str, warn: Warn,
             check_images: bool) -> Glass | None:
    """The first glass node that feeds the output's Surface; other shaders beside it are warned of."""
    ignored = []
    glass = None
    for shader, groups in nodes.shader_nodes(nodes.Input(output.inputs["Surface"])):
        is_base = material.verglas.kind == 'COATED' and shader.type in _BASES
        read = _coated if is_base else _READERS.get(shader.type)
        if glass is None and read is not None:
            glass = read(material.name, nodes.Node(shader, groups, owner, warn), check_images)
            if glass is not None:
                continue
        ignored.append(nodes.title(shader))
    if glass is not None and ignored:
        warn(f"{owner}: only its first glass node is rendered; not supported yet beside it: "
             f"{', '.join(dict.fromkeys(ignored))}.")
    return glass


def _glass_bsdf(name: str, node: nodes.Node, check_images: bool) -> Glass:
    glass = _microfacet(name, node, check_images)
    glass.fresnel = True
    glass.color = node.color("Color")
    glass.reflection_color = glass.color
    return glass


def _refraction_bsdf(name: str, node: nodes.Node, check_images: bool) -> Glass:
    glass = _microfacet(name, node, check_images)
    glass.fresnel = False
    glass.color = node.color("Color")
    return glass


def _principled_bsdf(name: str, node: nodes.Node, check_images: bool) -> Glass | None:
    metallic = np.clip(node.scalar("Metallic"), 0.0, 1.0)
    transmission = np.clip(node.scalar(*compat.TRANSMISSION), 0.0, 1.0) * (1.0 - metallic)
    if transmission == 0.0:
        return _principled_coat(name, node, check_images)
    if transmission < 1.0:
        node.warn(f"lets only {transmission:.0%} of the light through, which isn't supported yet; "
                  "it is rendered as glass altogether")
    if node.scalar("Alpha", default=1.0) < 1.0:
        node.warn("has an Alpha below 1, which isn't supported yet; it is rendered as 1")
    base_color = node.color("Base Color")
    glass = _microfacet(name, node, check_images)
    glass.fresnel = True
    glass.color = compat.principled_transmission_tint(base_color)
    glass.reflection_color = compat.principled_reflection_tint(base_color, node.color("Specular Tint"))
    if node.node.distribution == 'GGX':
        smoothness = 1.0 - node.scalar("Transmission Roughness")
        glass.roughness = 1.0 - (1.0 - glass.roughness) * smoothness
        if glass.roughness_map is not None and smoothness != 1.0:
            glass.roughness_map = glass.roughness_map.then(
                lambda values: 1.0 - (1.0 - values) * smoothness, ("Transmission Roughness", smoothness))
    return glass


def _principled_coat(name: str, node: nodes.Node, check_images: bool) -> Glass | None:
    """None without a coat."""
    weight = node.scalar(*compat.COAT)
    if weight <= 0.0:
        return None
    if weight < 1.0:
        node.warn(f"has a coat of weight {weight:.2g}; it is rendered as a whole one")
    glass = _coated(name, node, check_images)
    _set_roughness(glass, node.input(*compat.COAT_ROUGHNESS), node, check_images)
    if node.input("Coat IOR") is not None:
        glass.ior = _ior(node, "Coat IOR")
    tint = np.ones(3) if node.input("Coat Tint") is None else np.clip(node.color("Coat Tint"), 1e-3, 1.0)
    # Straight there and back
    glass.absorption = -np.log(tint) / (2.0 * glass.layer.thickness)
    return glass


def _coated(name: str, node: nodes.Node, check_images: bool) -> Glass:
    """A clear layer on what the node is of."""
    glass = Glass(name)
    glass.kind = 'COATED'
    layer = glass.layer
    layer.base_color = np.clip(node.color("Base Color", "Color"), 0.0, 1.0)
    metallic = node.scalar("Metallic", default=0.0)
    is_matte = node.node.type == 'BSDF_PRINCIPLED' and metallic < 0.5
    layer.diffuse = is_matte or node.node.type == 'BSDF_DIFFUSE'
    if 0.0 < metallic < 1.0:
        base = "diffuse" if layer.diffuse else "metal"
        node.warn(f"is metallic by {metallic:.2g}, which isn't supported yet; its base is rendered as {base}")
    if not layer.diffuse:
        layer.roughness, glass.inner_roughness_map = _roughness(node.input("Roughness"), node, check_images)
    _set_relief(glass, node, check_images)
    return glass


_READERS = {
    'BSDF_GLASS': _glass_bsdf,
    'BSDF_REFRACTION': _refraction_bsdf,
    'BSDF_PRINCIPLED': _principled_bsdf,
}

_BASES = frozenset({'BSDF_DIFFUSE', 'BSDF_GLOSSY', 'BSDF_METALLIC', 'BSDF_PRINCIPLED'})
"""Types of the shader nodes that a material of kind 'COATED' has its base from."""

GLASS_NODES = frozenset(_READERS)
"""Types of the shader nodes that can be glass."""


def _microfacet(name: str, node: nodes.Node, check_images: bool) -> Glass:
    """What the three glass nodes have in common."""
    glass = Glass(name)
    distribution = node.node.distribution
    glass.ndf = NDF_OF_DISTRIBUTION[distribution]
    if distribution == 'SHARP':
        glass.roughness = 0.0
    else:
        _set_roughness(glass, node.input("Roughness"), node, check_images)
    glass.ior = _ior(node, "IOR")
    _set_relief(glass, node, check_images)
    return glass


def _set_roughness(glass: Glass, found: nodes.Input, node: nodes.Node, check_images: bool) -> None:
    glass.roughness, glass.roughness_map = _roughness(found, node, check_images)


def _roughness(found: nodes.Input, node: nodes.Node,
               check_images: bool) -> tuple[float, expressions.Expression | None]:
    """The node's value for an input, and what is in its place where it varies."""
    expression = None
    roughness = nodes.own_value(found.socket)
    try:
        expression = expression_of(found, check_images)
    except expressions.Unsupported as fault:
        node.warn(f"takes its {found.socket.name} from {fault}; the input's own value is used")
    else:
        if expression.is_constant:
            roughness, expression = float(expression.evaluate(expressions.Points({}))), None
    return float(np.clip(roughness, 0.0, 1.0)), expression


def _set_relief(glass: Glass, node: nodes.Node, check_images: bool) -> None:
    glass.relief = relief_of(node, check_images)
    normals, heights = glass.relief
    if normals is not None:
        glass.normal_map.space = normals.space
        glass.normal_map.steepness, glass.normal_map.strength = normals.steepness, normals.strength
    if heights is not None:
        glass.bump_map.strength, glass.bump_map.distance = heights.strength, heights.distance


def _ior(node: nodes.Node, name: str) -> float:
    ior = node.scalar(name)
    clamped = float(np.clip(ior, *IOR_RANGE))
    if not np.isclose(ior, clamped):
        node.warn(f"has an IOR of {ior:g}; it is rendered with {clamped:.3g}, as indices reach from 1/3 to 3")
    return clamped


def _volume(output: bpy.types.Node, glass: Glass, owner: str, warn: Warn) -> bool:
    """Sets the absorption from the output's Volume; returns whether anything is linked to it."""
    volumes = list(nodes.shader_nodes(nodes.Input(output.inputs["Volume"])))
    absorbing = next((volume for volume in volumes if volume[0].type == 'VOLUME_ABSORPTION'), None)
    if absorbing is not None:
        node = nodes.Node(*absorbing, owner, warn)
        glass.absorption = _absorption(node.color("Color"), node.scalar("Density"))
    ignored = dict.fromkeys(nodes.title(node) for node, groups in volumes if (node, groups) != absorbing)
    if ignored:
        warn(f"{owner}: only one Volume Absorption is rendered; not supported yet beside it: "
             f"{', '.join(ignored)}.")
    return bool(volumes)


def _apply_panel(material: bpy.types.Material, glass: Glass, warn: Warn, check_images: bool,
                 has_volume: bool) -> None:
    """What the Verglas panel adds to the nodes."""
    settings = material.verglas
    if (glass.kind == 'COATED') != (settings.kind == 'COATED') and settings.kind != 'SOLID':
        wanted = "a thin pane" if settings.kind == 'PANE' else "coated"
        warn(f"Material '{material.name}' can't be {wanted} with the shader that it has; "
             f"it is rendered as {'coated' if glass.kind == 'COATED' else 'solid glass'}.")
    if glass.kind == 'COATED':
        _apply_coating(material, glass, warn, check_images)
    elif settings.kind == 'PANE':
        _apply_pane(material, glass, warn, check_images)
    if settings.ndf != 'NODES':
        glass.ndf = settings.ndf
    if settings.absorption_density > 0.0 and not has_volume:
        glass.absorption = _absorption(np.array(settings.absorption_color), settings.absorption_density)
    glass.priority = settings.priority
    glass.bake_resolution = int(settings.bake_resolution)


def _apply_pane(material: bpy.types.Material, glass: Glass, warn: Warn, check_images: bool) -> None:
    settings = material.verglas
    glass.kind = 'PANE'
    glass.layer.roughness = settings.inner_roughness
    glass.layer.inner_reflections = settings.inner_reflections
    glass.inner_roughness_map = _of_image(settings.inner_image, "inner", material, warn, check_images)


def _apply_coating(material: bpy.types.Material, glass: Glass, warn: Warn, check_images: bool) -> None:
    settings = material.verglas
    layer = glass.layer
    layer.bounces = settings.bounces
    if settings.kind != 'COATED':
        return  # a Principled BSDF's coat
    glass.roughness, glass.ior = settings.outer_roughness, settings.coating_ior
    glass.roughness_map = _of_image(settings.outer_image, "outer", material, warn, check_images)
    layer.thickness = settings.thickness
    if settings.metal != 'NODES':
        layer.diffuse = False
        layer.base_color, layer.edge_tint = conductors.reflectance(settings.metal, glass.ior)


def _of_image(image: bpy.types.Image | None, side: str, material: bpy.types.Material, warn: Warn,
              check_images: bool) -> expressions.Expression | None:
    """Roughness of a side; None where it has its value."""
    if image is None:
        return None
    try:
        return expression_of_image(image, check_images)
    except images.Unreadable as fault:
        warn(f"Material '{material.name}' takes its {side} roughness from image '{image.name}', which "
             f"{fault}; its own value is used.")
        return None


def _absorption(color: np.ndarray, density: float) -> np.ndarray:
    """(3,) sigma_a per unit of length, as Cycles' Volume Absorption defines it."""
    return max(density, 0.0) * np.maximum(1.0 - color, 0.0)


def _warn_of_displacement(output: bpy.types.Node, owner: str, warn: Warn) -> None:
    source = nodes.Input(output.inputs["Displacement"]).source()
    if source.node is not None:
        warn(f"{owner}: '{nodes.title(source.node)}' displaces the surface, which isn't supported yet; "
             "it is left out.")
