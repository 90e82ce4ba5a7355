# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings that Verglas adds to scenes and materials."""

import bpy
from bpy.props import (
    BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty,
)

from .conductors import INDICES


def _noticed(settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Has viewports updated where a script sets a property; Blender does so where the user does."""
    settings.id_data.update_tag()


class VerglasSceneSettings(bpy.types.PropertyGroup):
    method: EnumProperty(
        name="Method",
        description="How final frames are rendered; the viewport is always real time",
        items=(
            ('REAL_TIME', "Real Time", "Lobes of light, without noise"),
            ('REFERENCE', "Reference", "Path tracing of the same glass, to check a real-time frame by"),
        ),
        default='REAL_TIME',
    )
    device: EnumProperty(
        name="Device",
        description="What renders the viewport and final frames in real time",
        items=(
            ('AUTO', "Auto", "OpenGL on a graphics card; the CPU where there is none, or no driver for it"),
            ('OPENGL', "OpenGL",
             "The graphics card: glass as far as the camera sees its nearest and farthest surfaces"),
            ('CPU', "CPU",
             "Traced: light is followed through all of the glass, hollows, glass behind glass and inner "
             "reflections too"),
        ),
        default='AUTO',
        update=_noticed,
    )
    traced_final: BoolProperty(
        name="Traced Final Frames",
        description="Render final frames by the CPU, through all of the glass, whatever draws the viewport",
        default=False,
    )
    max_interfaces: IntProperty(
        name="Interfaces",
        description="How many surfaces light is followed through, where it enters, leaves or is reflected "
                    "inside; beyond, it comes from the world straight away. Fewer are faster",
        default=8, min=1, max=64,
        update=_noticed,
    )
    reference_samples: IntProperty(
        name="Samples",
        description="Paths for each pixel. Powers of two converge best",
        default=256, min=1, max=1 << 20, soft_max=4096,
    )
    reference_paths: EnumProperty(
        name="Paths",
        description="Which light is followed",
        items=(
            ('FULL', "Full", "All: reflection, inner reflections, light that enters again"),
            ('TWO_INTERFACE', "Two Interfaces", "Light that enters, leaves and is gone, as in real time"),
        ),
        default='FULL',
    )
    reference_tir: BoolProperty(
        name="Total Internal Reflection",
        description="Follow totally reflected light inside until it leaves; else it is lost",
        default=False,
    )
    reference_seed: IntProperty(
        name="Seed",
        description="Another seed gives other noise",
        default=0, min=0,
    )
    samples: IntProperty(
        name="Samples",
        description="Jittered samples for each pixel. One is free of noise; more smooth edges, and by the "
                    "CPU make the light in the glass more exact",
        default=16, min=1, max=65536, soft_max=256,
    )
    viewport_samples: IntProperty(
        name="Viewport Samples",
        description="Jittered samples for each pixel that the viewport gathers while nothing changes",
        default=16, min=1, max=65536, soft_max=256,
        update=_noticed,
    )
    filter_width: FloatProperty(
        name="Filter Width",
        description="Width of the Blackman-Harris pixel filter",
        default=1.5, min=0.01, max=10.0, subtype='PIXEL',
        update=_noticed,
    )
    transport: EnumProperty(
        name="Transport",
        description="How light crosses the object",
        items=(
            ('BUNDLE', "Bundle", "Four rays, each refracted by the normal at its own exit; the most exact"),
            ('PAPER', "Paper", "One lobe against the exit region's mean normal (de Rousiers et al. 2012)"),
            ('SINGLE', "Single", "One ray along the lobe's axis"),
            ('DEPTH_MIP', "Depth Mip",
             "One sharp ray, blurred by the distance that it travels inside (Eisemann and Décoret 2006)"),
            ('SPECULAR', "Specular", "Sharp refraction, as if the glass were smooth (Wyman 2005)"),
        ),
        default='BUNDLE',
        update=_noticed,
    )
    intersection: EnumProperty(
        name="Intersection",
        description="How a ray finds the back of the object",
        items=(
            ('NEWTON', "Newton", "Newton steps on the tangent planes of the back; fast"),
            ('MARCH', "March", "March through the depth map; for comparison"),
        ),
        default='NEWTON',
        update=_noticed,
    )
    lobes: EnumProperty(
        name="Lobes",
        description="What is known of the lobes of light that rough surfaces refract and reflect",
        items=(
            ('TABLE', "Table", "Tables, computed once for each distribution of microfacets; the most exact"),
            ('ANALYTIC', "Analytic",
             "Closed forms, with nothing to compute beforehand; less exact, above all for GGX and near the "
             "critical angle (Guo et al. 2015)"),
        ),
        default='TABLE',
        update=_noticed,
    )
    tir: EnumProperty(
        name="Total Internal Reflection",
        description="What becomes of light that cannot leave the glass",
        items=(
            ('NONE', "None", "It is lost"),
            ('INCIDENT', "Incident", "It goes on unrefracted"),
            ('CLAMP', "Clamp", "It leaves along the surface"),
            ('BOUNCE', "Bounce",
             "It is followed to where it leaves next, three times, and so is what is reflected in part; the "
             "closest to the truth, above all in facets and necks, and the slowest. For Bundle with Newton; "
             "else as Clamp"),
        ),
        default='CLAMP',
        update=_noticed,
    )
    back_roughness: EnumProperty(
        name="Back Roughness",
        description="What the back of the glass has of a texture of roughness; the front has all of it",
        items=(
            ('SIMPLE', "Simple", "The texture's mean: what is painted on the back isn't seen"),
            ('COVERAGE', "Coverage",
             "Classes of roughness, each by the part of the back that it covers: what is painted there is "
             "seen through the front"),
        ),
        default='COVERAGE',
        update=_noticed,
    )
    roughness_classes: IntProperty(
        name="Classes",
        description="How many classes stand for the roughnesses of a texture, at most; those between two are "
                    "mixed from both. More are slower",
        default=4, min=2, max=8,
        update=_noticed,
    )
    reflection: BoolProperty(
        name="Reflection",
        description="Reflect the world in the front of the glass, where the material does",
        default=True,
        update=_noticed,
    )


class VerglasMaterialSettings(bpy.types.PropertyGroup):
    kind: EnumProperty(
        name="Kind",
        description="What is behind the surface. A Principled BSDF with a coat and without transmission "
                    "is Coated by itself",
        items=(
            ('SOLID', "Solid", "Glass that fills the object"),
            ('PANE', "Thin Pane",
             "A sheet of glass with two rough sides, as window glass, bulbs and packaging. The mesh is the "
             "sheet, open or closed; its normals show to the outer side, of the shader node's roughness"),
            ('COATED', "Coated",
             "A clear layer on what the material's Diffuse, Glossy or Principled BSDF is, which gives the "
             "base's color and roughness"),
        ),
        default='SOLID',
        update=_noticed,
    )
    inner_roughness: FloatProperty(
        name="Inner Roughness",
        description="Of the other side, where the mesh's normals don't show to",
        default=0.25, min=0.0, max=1.0, subtype='FACTOR',
        update=_noticed,
    )
    inner_image: PointerProperty(
        name="Inner Image",
        description="Roughness of the other side in place of the value: brightness over the default UV map",
        type=bpy.types.Image,
        update=_noticed,
    )
    inner_reflections: BoolProperty(
        name="Inner Reflections",
        description="Add the light that is reflected between both sides",
        default=True,
        update=_noticed,
    )
    outer_roughness: FloatProperty(
        name="Outer Roughness",
        description="Of the clear layer",
        default=0.1, min=0.0, max=1.0, subtype='FACTOR',
        update=_noticed,
    )
    outer_image: PointerProperty(
        name="Outer Image",
        description="Roughness of the clear layer in place of the value: brightness over the default UV map",
        type=bpy.types.Image,
        update=_noticed,
    )
    coating_ior: FloatProperty(
        name="IOR",
        description="Index of refraction of the clear layer",
        default=1.5, min=1.0, max=3.0,
        update=_noticed,
    )
    thickness: FloatProperty(
        name="Thickness",
        description="Of the clear layer, along the normal: how far its absorption acts",
        default=0.01, min=0.0, soft_max=1.0, subtype='DISTANCE',
        update=_noticed,
    )
    bounces: IntProperty(
        name="Bounces",
        description="How often light that leaves the layer has met its base, at most; with 0 only the outer "
                    "side is seen",
        default=2, min=0, max=8,
        update=_noticed,
    )
    metal: EnumProperty(
        name="Base",
        description="What the clear layer lies on",
        items=(
            ('NODES', "From Nodes", "As the material's shader node says"),
            *((name, name.title(), "") for name in sorted(INDICES)),
        ),
        default='NODES',
        update=_noticed,
    )
    ndf: EnumProperty(
        name="Distribution",
        description="Distribution of microfacet normals",
        items=(
            ('NODES', "From Nodes", "As the material's shader node says"),
            ('BECKMANN', "Beckmann", "Gaussian slopes"),
            ('GGX', "GGX", "Long tails, as ground glass has"),
            ('BLINN_PHONG', "Blinn-Phong", "Cosine power, as in the paper"),
        ),
        default='NODES',
        update=_noticed,
    )
    absorption_color: FloatVectorProperty(
        name="Absorption Color",
        description="Color that remains of white light inside, where the material has no volume node",
        subtype='COLOR', size=3, min=0.0, max=1.0, default=(0.8, 0.8, 0.8),
        update=_noticed,
    )
    absorption_density: FloatProperty(
        name="Absorption Density",
        description="Absorption for each unit of length, as in the Volume Absorption node; 0 is clear",
        default=0.0, min=0.0, soft_max=100.0,
        update=_noticed,
    )
    bake_resolution: EnumProperty(
        name="Bake Resolution",
        description="Pixels along each side of the textures into which roughness, normals and bumps are "
                    "baked where they come from procedural textures, generated or object coordinates, or "
                    "several UV maps",
        items=tuple((str(2 ** k), f"{2 ** k} px", "") for k in range(8, 13)),
        default='1024',
        update=_noticed,
    )
    priority: IntProperty(
        name="Priority",
        description="Which material counts where objects overlap, as a drink that reaches into the wall of "
                    "its glass: the one of higher priority. IOR is then the material's own in any "
                    "surroundings. 0: as in Cycles, IOR is relative to what is around the surface",
        default=0, min=0, soft_max=10,
        update=_noticed,
    )


_classes = (VerglasSceneSettings, VerglasMaterialSettings)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.verglas = PointerProperty(type=VerglasSceneSettings)
    bpy.types.Material.verglas = PointerProperty(type=VerglasMaterialSettings)


def unregister():
    del bpy.types.Material.verglas
    del bpy.types.Scene.verglas
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
