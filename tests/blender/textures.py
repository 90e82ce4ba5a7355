# SPDX-License-Identifier: GPL-3.0-or-later
"""A plane whose roughness varies, as Cycles evaluates the nodes and as the core gets it."""

from collections.abc import Callable

import bpy
import numpy as np
from scenes import add, add_node, new_material, node_of, render
from verglas import verglas_core as core
from verglas.sync import materials, meshes, painting

PIXELS = 24
"""Along each side of the picture of the plane."""

Build = Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]
"""Adds nodes and returns the output that goes into Roughness."""


def textured(build: Build, roughness: float = 0.3) -> bpy.types.Material:
    """Glass, with the output of the nodes in its Roughness."""
    material = new_material("Ice", Roughness=roughness)
    tree = material.node_tree
    material.verglas.bake_resolution = "256"
    tree.links.new(build(tree), node_of(tree, "ShaderNodeBsdfGlass").inputs["Roughness"])
    return material


def add_plane(material: bpy.types.Material, cells: int = 1, uv_range=(0.0, 1.0)) -> bpy.types.Object:
    """From (-1, -1) to (1, 1), of cells x cells quads; its UV map 'UVMap' goes across it over uv_range."""
    line = np.linspace(-1.0, 1.0, cells + 1)
    y, x = np.meshgrid(line, line, indexing='ij')
    i = np.arange(cells * (cells + 1)).reshape(cells, -1)[:, :-1].ravel()
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata(np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3).tolist(), [],
                     np.stack([i, i + 1, i + cells + 2, i + cells + 1], axis=-1).tolist())
    mesh.materials.append(material)
    set_uvs(mesh, "UVMap", uv_range)
    return add(mesh, "Plane")


def set_uvs(mesh: bpy.types.Mesh, name: str, uv_range: tuple[float, float]) -> None:
    """Adds the UV map if need be."""
    layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name)
    corners = np.empty(len(mesh.loops), np.intc)
    mesh.loops.foreach_get("vertex_index", corners)
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    places = 0.5 + 0.5 * positions.reshape(-1, 3)[corners, :2]
    layer.data.foreach_set("uv", (uv_range[0] + places * (uv_range[1] - uv_range[0])).ravel())


def of_cycles(scene: bpy.types.Scene, plane: bpy.types.Object) -> np.ndarray:
    """(PIXELS, PIXELS): what goes into the material's Roughness at the pixels' centres, by Cycles."""
    tree = plane.data.materials[0].node_tree
    rough = node_of(tree, "ShaderNodeBsdfGlass").inputs["Roughness"]
    emission = add_node(tree, "ShaderNodeEmission", Color=(1, 1, 1, 1))
    tree.links.new(rough.links[0].from_socket, emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], node_of(tree, "ShaderNodeOutputMaterial").inputs["Surface"])
    camera = bpy.data.cameras.new("Above")
    camera.type, camera.ortho_scale = 'ORTHO', 2.0
    scene.camera = add(camera, "Above", location=(0.0, 0.0, 5.0))
    scene.render.engine = 'CYCLES'
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = 'BOX', 0.01
    return render(scene).rgb[..., 0]


def of_verglas(plane: bpy.types.Object, warn, depsgraph: bpy.types.Depsgraph | None = None) -> np.ndarray:
    """The same, by the texture and coordinates that the core gets; a constant where there is no texture.
    depsgraph: default the viewport's."""
    if depsgraph is None:
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = plane.evaluated_get(depsgraph)
    glass = materials.from_blender(evaluated.data.materials[0], warn)
    if glass.roughness_map is None:
        return np.full((PIXELS, PIXELS), glass.roughness)
    arrays = meshes.read(evaluated)
    surface = meshes.Surface(evaluated, arrays, 0, warn)
    return sampled(arrays, painting.paint(glass.roughness_map, surface, glass.bake_resolution))


def sampled(arrays: meshes.MeshArrays, painted: painting.Painting) -> np.ndarray:
    """(PIXELS, PIXELS) of a plane from (-1, -1) to (1, 1)."""
    line = (np.arange(PIXELS) + 0.5) / PIXELS * 2.0 - 1.0
    y, x = np.meshgrid(line, line, indexing='ij')
    points = np.stack([x.ravel(), y.ravel()], axis=-1)
    a, b, c = np.moveaxis(arrays.positions[arrays.triangles][..., :2].astype(float), 1, 0)
    edges = np.stack([b - a, c - a], axis=-1)
    inside = np.einsum('tij,ptj->pti', np.linalg.inv(edges), points[:, None] - a)
    weights = np.concatenate([1.0 - inside.sum(axis=-1, keepdims=True), inside], axis=-1)
    triangle = weights.min(axis=-1).argmax(axis=-1)
    at = weights[np.arange(len(points)), triangle]
    uvs = np.einsum('pk,pkc->pc', at, painted.uvs[triangle].astype(float))
    return painted.texture.sample(uvs).reshape(PIXELS, PIXELS)


def new_image(pixels: np.ndarray, name: str = "Frost", space: str = 'Non-Color', is_float: bool = True,
              alpha: bool = False) -> bpy.types.Image:
    """pixels: (H, W, 3 or 4), row 0 at the bottom."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=alpha, float_buffer=is_float,
                                is_data=space == 'Non-Color')
    image.colorspace_settings.name = space
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :pixels.shape[2]] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    return image


def add_image(tree: bpy.types.NodeTree, image: bpy.types.Image, vector: bpy.types.NodeSocket | None = None,
              **values) -> bpy.types.Node:
    """An Image Texture node."""
    node = add_node(tree, "ShaderNodeTexImage", **values)
    node.image = image
    if vector is not None:
        tree.links.new(vector, node.inputs["Vector"])
    return node


def link(tree: bpy.types.NodeTree, kind: str, sources: dict[int, bpy.types.NodeSocket],
         output: int = 0, **values) -> bpy.types.NodeSocket:
    """An output of a new node with linked inputs, by their numbers."""
    node = add_node(tree, kind, **values)
    for number, source in sources.items():
        tree.links.new(source, node.inputs[number])
    return node.outputs[output]


def texture_of(scene: core.Scene) -> core.Texture | None:
    """Of the scene's only material."""
    material, = scene.materials
    return material.roughness_texture
