# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the Blender versions 3.4 to 5.2 that matters here."""

import bpy
import numpy as np

VERSION: tuple[int, int, int] = bpy.app.version

TRANSMISSION = ("Transmission Weight", "Transmission")
"""Names of Principled BSDF's transmission input; it was renamed in 4.0."""

COAT = ("Coat Weight", "Coat", "Clearcoat")
COAT_ROUGHNESS = ("Coat Roughness", "Clearcoat Roughness")
"""Names of Principled BSDF's inputs for its coat; they were renamed in 4.0."""

ADOPTED_PANELS = (
    'DATA_PT_EEVEE_light',
    'EEVEE_MATERIAL_PT_context_material',
    'EEVEE_MATERIAL_PT_surface',
    'EEVEE_MATERIAL_PT_volume',
    'EEVEE_WORLD_PT_surface',
)
"""Built-in panels that users of any engine need but that don't offer themselves to all."""

LINEAR_COLOR_SPACES = frozenset({'Linear', 'Linear Rec.709', 'Non-Color', 'Raw'})
"""Names of the image colour spaces whose values are scene-linear already ('Linear' until 3.6)."""

EEVEE = 'BLENDER_EEVEE_NEXT' if (4, 2, 0) <= VERSION < (5, 0, 0) else 'BLENDER_EEVEE'
"""EEVEE's name as a render engine."""

UNIFORM_COLOR_SHADER = 'UNIFORM_COLOR' if VERSION >= (4, 0, 0) else '2D_UNIFORM_COLOR'
"""Name of Blender's own shader of one colour."""

EXR = {"file_format": 'OPEN_EXR', "color_mode": 'RGB', "color_depth": '32'}
"""Image settings, in the order in which they must be set, for a scene-linear float32 picture."""
if VERSION >= (5, 0, 0):
    EXR = {"media_type": 'IMAGE'} | EXR


def uses_nodes(owner: bpy.types.Material | bpy.types.World) -> bool:
    """Whether nodes define it; from 5.0 they always do, and asking use_nodes warns."""
    return owner.node_tree is not None and (VERSION >= (5, 0, 0) or owner.use_nodes)


def use_nodes(owner: bpy.types.Material | bpy.types.World) -> None:
    """Makes nodes define it."""
    if VERSION < (5, 0, 0):
        owner.use_nodes = True


def principled_transmission_tint(base_color: np.ndarray) -> np.ndarray:
    """RGB factor of one refraction through Principled BSDF: the base colour until 3.6, from 4.0
    its square root, so that entering and leaving together give the base colour."""
    return base_color if VERSION < (4, 0, 0) else np.sqrt(np.clip(base_color, 0.0, 1.0))


def principled_reflection_tint(base_color: np.ndarray, specular_tint: np.ndarray) -> np.ndarray:
    """RGB factor of Principled BSDF's reflection: Specular Tint blends to the base colour until 3.6;
    from 4.0 it is a colour itself."""
    return 1.0 - specular_tint + base_color * specular_tint if VERSION < (4, 0, 0) else specular_tint


STRENGTH_STEEPENS_NORMAL_MAPS = VERSION >= (4, 0, 0)
"""Whether the strength of a Normal Map node in tangent space is a factor of the map's slopes; else it mixes
normals, as in other spaces."""


def is_directx(normal_map: bpy.types.ShaderNodeNormalMap) -> bool:
    """Whether green points down in a Normal Map node's colours; 5.1 brought the choice."""
    return getattr(normal_map, "convention", 'OPENGL') == 'DIRECTX'


def has_vertex_normals(mesh: bpy.types.Mesh) -> bool:
    """Whether the faces at a vertex share one normal: all smooth, nothing sharp, nothing custom."""
    if VERSION >= (4, 1, 0):
        return mesh.normals_domain == 'POINT'
    if mesh.use_auto_smooth:
        return False
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return bool(smooth.all())


def corner_normals(mesh: bpy.types.Mesh) -> np.ndarray:
    """(C, 3) float32 normals of the face corners: flat, sharp and custom ones included. Until 4.0
    Blender stores them in the mesh, so it must be a temporary one."""
    normals = np.empty(3 * len(mesh.loops), np.float32)
    if VERSION >= (4, 1, 0):
        mesh.corner_normals.foreach_get("vector", normals)
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


def uvs_of(layer: bpy.types.MeshUVLoopLayer) -> np.ndarray:
    """(C, 2) float32 of the face corners."""
    values, name = (layer.uv, "vector") if VERSION >= (3, 5, 0) else (layer.data, "uv")
    uvs = np.empty(2 * len(values), np.float32)
    values.foreach_get(name, uvs)
    return uvs.reshape(-1, 2)


def world_of(depsgraph: bpy.types.Depsgraph) -> bpy.types.World | None:
    """The evaluated world; view layers can override the scene's from 4.3."""
    override = getattr(depsgraph.view_layer_eval, "world_override", None)
    return override or depsgraph.scene_eval.world


def keep_subdivided_meshes_valid() -> None:
    """To be called after each undo and redo. Until 4.0 they free what a Subdivision Surface modifier keeps of
    an object that they change (modifiers get new session UUIDs as they are read, by which the depsgraph would
    keep that), but an evaluated mesh to be subdivided on the GPU still points to it unless it is made again.
    The next one who has it subdivided, to_mesh() or the Solid viewport, would end Blender, whatever the
    engine."""
    if VERSION >= (4, 1, 0) or not bpy.context.preferences.system.use_gpu_subdivision:
        return
    for obj in bpy.data.objects:
        if any(modifier.type == 'SUBSURF' for modifier in obj.modifiers):
            obj.update_tag(refresh={'DATA'})


def write_pass(render_pass: bpy.types.RenderPass, pixels: np.ndarray) -> None:
    """Fill a pass of the render result. pixels: float32, one value for each pixel and channel,
    row 0 at the bottom. Older versions count pixels where newer ones count values."""
    pixels = np.ascontiguousarray(pixels, np.float32)
    try:
        render_pass.rect.foreach_set(pixels.reshape(-1))
    except TypeError:
        render_pass.rect.foreach_set(pixels.reshape(-1, render_pass.channels))
