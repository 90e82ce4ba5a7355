# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the sample scenes that stand beside this script.

    blender --background --factory-startup --python blend_files/make_scenes.py [-- NAME ...]

The add-on has to be installed. Every scene is one object at the origin, of frosted glass or coated, under
the same HDR map but for the sunlit slab, which a sun stands behind. All meshes but Blender's monkey and the
pane's sheet are closed with outward normals, which is checked; the monkey is open behind its eyes, as Blender
makes it.
"""

import sys
from collections.abc import Callable
from math import acos, atan2, cos, degrees, pi, radians, sin, sqrt, tan
from pathlib import Path
from typing import NamedTuple

import addon_utils
import bmesh
import bpy
from mathutils import Matrix, Vector

FOLDER = Path(__file__).resolve().parent
ENVIRONMENT = "environments/rooitou_park_1k.exr"
ENVIRONMENT_ROTATION = radians(160)
LAND_MASK = "textures/land_mask.png"
ENGINE = "VERGLAS"


# Meshes

def new_mesh(name, bm, smooth, closed=True):
    """The bmesh as a mesh; what is closed is checked to be so and turned outwards. Frees the bmesh."""
    for edge in bm.edges if closed else ():
        assert len(edge.link_faces) == 2, f"{name}: an edge has {len(edge.link_faces)} faces"
        assert edge.is_contiguous, f"{name}: neighbouring faces are wound against each other"
    assert not closed or bm.calc_volume(signed=True) > 0, f"{name}: the normals point inwards"
    for face in bm.faces:
        face.smooth = smooth
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    bm.free()
    return mesh


def revolve(profile, segments):
    """The solid of revolution about Z. profile: (radius, z) from the top pole to the bottom pole."""
    bm = bmesh.new()
    top = bm.verts.new((0, 0, profile[0][1]))
    bottom = bm.verts.new((0, 0, profile[-1][1]))
    angles = [2 * pi * i / segments for i in range(segments)]
    rings = [[bm.verts.new((r * cos(a), r * sin(a), z)) for a in angles] for r, z in profile[1:-1]]
    for i in range(segments):
        j = (i + 1) % segments
        bm.faces.new((top, rings[0][i], rings[0][j]))
        for upper, lower in zip(rings, rings[1:]):
            bm.faces.new((upper[i], lower[i], lower[j], upper[j]))
        bm.faces.new((bottom, rings[-1][j], rings[-1][i]))
    return bm


def arc(center, radius, start, end, steps):
    """Points on a circle in the (radius, z) plane, from angle start to end (degrees, counter-clockwise)."""
    angles = [radians(start + (end - start) * i / steps) for i in range(steps + 1)]
    return [(center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in angles]


def line(start, end, steps):
    return [tuple(Vector(start).lerp(end, i / steps)) for i in range(steps + 1)]


def shoulder(start, end, steps):
    """Points from start to end, upright at both."""
    def smoothstep(t):
        return t * t * t * (t * (6 * t - 15) + 10)
    return [(start[0] + (end[0] - start[0]) * smoothstep(i / steps), z)
            for i, (_, z) in enumerate(line(start, end, steps))]


def without_repeats(points):
    return [p for i, p in enumerate(points) if i == 0 or (Vector(p) - Vector(points[i - 1])).length > 1e-6]


def monkey():
    """Blender's monkey, 63k triangles when subdivided."""
    bpy.ops.mesh.primitive_monkey_add(size=2)
    object = bpy.context.object
    bpy.ops.object.shade_smooth()
    subdivision = object.modifiers.new("Subdivision", 'SUBSURF')
    subdivision.levels = subdivision.render_levels = 3
    return object


class Kitten:
    """A sitting kitten that looks along -Y, 2.3 high: balls, drawn out and in rows, joined and smoothed but
    for its eyes and nose, which stay by themselves."""

    VOXEL = 0.06

    def __init__(self):
        self.bm = bmesh.new()

    def ball(self, center, radii, pitch=0.0, subdivisions=3):
        """pitch: turn about X, degrees."""
        matrix = (Matrix.Translation(center) @ Matrix.Rotation(radians(pitch), 4, 'X')
                  @ Matrix.Diagonal((*radii, 1)))
        bmesh.ops.create_icosphere(self.bm, subdivisions=subdivisions, radius=1, matrix=matrix)

    def row(self, points, radii):
        """Balls from point to point, of radii from each to the next."""
        for (start, end), (first, last) in zip(zip(points, points[1:]), zip(radii, radii[1:])):
            steps = max(int((Vector(end) - Vector(start)).length / 0.03), 1)
            for i in range(steps + 1):
                radius = first + (last - first) * i / steps
                self.ball(Vector(start).lerp(end, i / steps), 3 * (radius,))

    def body(self):
        self.ball((0, 0.18, -0.52), (0.52, 0.56, 0.60), pitch=-18)
        self.ball((0, -0.16, -0.22), (0.40, 0.38, 0.52), pitch=-10)

    def head(self):
        self.ball((0, -0.22, 0.54), (0.62, 0.52, 0.49))
        self.ball((0, -0.69, 0.50), (0.10, 0.10, 0.13))  # bridge of the nose
        self.ball((0, -0.69, 0.255), (0.12, 0.10, 0.07))  # chin

    def paired(self, side):
        """What is on one side: -1 or 1."""
        self.ball((0.38 * side, 0.16, -0.73), (0.33, 0.48, 0.40), pitch=-12)  # haunch
        self.ball((0.42 * side, -0.36, -1.03), (0.17, 0.28, 0.12))  # hind paw
        self.row([(0.19 * side, -0.36, -0.25), (0.17 * side, -0.50, -1.0)], [0.20, 0.14])  # foreleg
        self.ball((0.18 * side, -0.60, -1.03), (0.17, 0.20, 0.12))  # forepaw
        self.ball((0.34 * side, -0.36, 0.40), (0.28, 0.26, 0.22))  # cheek
        self.ball((0.12 * side, -0.74, 0.37), (0.14, 0.12, 0.11))  # muzzle
        self.ear(side)

    def ear(self, side):
        base, tip = Vector((0.36 * side, -0.20, 0.84)), Vector((0.53 * side, -0.20, 1.24))
        for i in range(17):
            t = i / 16
            self.ball(base.lerp(tip, t), (0.05 + 0.22 * (1 - t) ** 0.8, 0.06 + 0.05 * (1 - t), 0.06))

    def tail(self):
        """From behind about the left side to before the paws."""
        points = [(0.70 * sin(radians(a)) + 0.05, 0.05 + 0.72 * -cos(radians(a)), -1.02)
                  for a in range(170, 10, -10)]
        self.row(points, [0.12 - 0.04 * i / (len(points) - 1) for i in range(len(points))])

    def eyes_and_nose(self):
        for side in (-1, 1):
            self.ball((0.25 * side, -0.59, 0.60), (0.14, 0.13, 0.125), subdivisions=2)
        self.ball((0, -0.80, 0.46), (0.075, 0.05, 0.05), subdivisions=2)

    def join(self):
        """What there is, with one smooth skin."""
        parts = bpy.data.objects.new("Parts", new_mesh("Parts", self.bm, smooth=True))
        bpy.context.scene.collection.objects.link(parts)
        remesh = parts.modifiers.new("Remesh", 'REMESH')
        remesh.mode, remesh.voxel_size = 'VOXEL', self.VOXEL
        parts.modifiers.new("Smooth", 'SMOOTH').iterations = 5
        self.bm = bmesh.new()
        self.bm.from_object(parts, bpy.context.evaluated_depsgraph_get())
        bpy.data.meshes.remove(parts.data)

    def mesh(self):
        self.body()
        self.head()
        self.tail()
        for side in (-1, 1):
            self.paired(side)
        self.join()
        self.eyes_and_nose()
        return new_mesh("Kitten", self.bm, smooth=True)


def kitten():
    """40k triangles when subdivided."""
    object = bpy.data.objects.new("Kitten", Kitten().mesh())
    subdivision = object.modifiers.new("Subdivision", 'SUBSURF')
    subdivision.levels = subdivision.render_levels = 1
    return object


def sphere():
    """Radius 1, 20k triangles: a cube whose grid is spread to equal angles and drawn to the sphere."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=2)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges[:], cuts=40, use_grid_fill=True)
    for vertex in bm.verts:
        vertex.co = Vector(tan(pi / 4 * c) for c in vertex.co).normalized()
    return bpy.data.objects.new("Sphere", new_mesh("Sphere", bm, smooth=True))


def lens():
    """Biconvex, radius 1, its axis along Y, the rim rounded off with a tangent arc."""
    curvature, rim_radius, radius = 1.6, 0.08, 1.0
    rim_center = radius - rim_radius
    # The rim touches both caps from inside: its centre lies curvature - rim_radius from theirs.
    depth = sqrt((curvature - rim_radius) ** 2 - rim_center ** 2)
    joint = degrees(acos(rim_center / (curvature - rim_radius)))
    cap = arc((0, -depth), curvature, 90, joint, 30)
    rim = arc((rim_center, 0), rim_radius, joint, -joint, 12)
    bm = revolve(without_repeats(cap + rim + [(r, -z) for r, z in reversed(cap)]), 72)
    bmesh.ops.rotate(bm, matrix=Matrix.Rotation(pi / 2, 3, 'X'), verts=bm.verts)
    return bpy.data.objects.new("Lens", new_mesh("Lens", bm, smooth=True))


def bottle():
    """A solid bottle, 2.4 high."""
    body, neck, corner, lip = 0.55, 0.17, 0.14, 0.06
    points = [(0, 1.2)]
    points += line((0.04, 1.2), (neck, 1.2), 3)
    points += arc((neck, 1.2 - lip), lip, 90, -90, 12)
    points += line((neck, 1.2 - 2 * lip), (neck, 0.65), 6)
    points += shoulder((neck, 0.65), (body, 0.05), 28)
    points += line((body, 0.05), (body, -1.2 + corner), 10)
    points += arc((body - corner, -1.2 + corner), corner, 0, -90, 10)
    points += line((body - corner, -1.2), (0, -1.2), 4)
    bm = revolve(without_repeats(points), 72)
    return bpy.data.objects.new("Bottle", new_mesh("Bottle", bm, smooth=True))


def slab():
    """A flat pane, 2 x 0.3 x 2, with narrow bevels."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=1, matrix=Matrix.Diagonal((2, 0.3, 2, 1)))
    bmesh.ops.bevel(bm, geom=bm.edges[:], offset=0.03, segments=3, profile=0.5, affect='EDGES')
    return bpy.data.objects.new("Slab", new_mesh("Slab", bm, smooth=False))


def sunlit_slab():
    """4.4 x 0.3 x 4.4, so that it covers the picture. Its back, away from the camera, has the second
    material."""
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=1, matrix=Matrix.Diagonal((4.4, 0.3, 4.4, 1)))
    for face in bm.faces:
        face.material_index = int(face.normal.y > 0.5)
    return bpy.data.objects.new("Sunlit Slab", new_mesh("Sunlit Slab", bm, smooth=False))


def globe():
    """A sphere with longitude and latitude as UV: 0 … 1 from longitude -180, and from the south pole."""
    bm = revolve([(sin(pi * i / 64), cos(pi * i / 64)) for i in range(65)], 128)
    layer = bm.loops.layers.uv.new("UVMap")
    for face in bm.faces:
        middle = face.calc_center_median()
        for loop in face.loops:
            x, y, z = loop.vert.co
            # At a pole that of the face; elsewhere on the face's side of the seam.
            at_pole = abs(z) > 1 - 1e-6
            longitude = atan2(middle.y, middle.x) if at_pole else atan2(y, x)
            turns = round((atan2(middle.y, middle.x) - longitude) / (2 * pi))
            loop[layer].uv = (longitude / (2 * pi) + turns + 0.5, 1 - acos(max(-1, min(z, 1))) / pi)
    return bpy.data.objects.new("Globe", new_mesh("Globe", bm, smooth=True))


def gem():
    """A round brilliant with Tolkowsky's angles, radius 1.3: 57 facets, girdle of 16 sides, pointed culet.

    Lengths are in units of the radius. The planes of the 8 main facets above and of those below touch the
    girdle at every other of its 16 corners; all other corners lie on these planes, and a reach is how far
    from the axis that is, measured along a main facet's middle.
    """
    radius, half_girdle = 1.3, 0.025
    crown, pavilion = tan(radians(34.5)), tan(radians(40.75))
    table_reach, star_reach, lower_reach = 0.55, 0.775, 0.25
    center = (crown * (1 - table_reach) - pavilion) / 2
    bm = bmesh.new()

    def ring(corners, reach, z):
        angles = [i * pi / 8 for i in corners]
        return [bm.verts.new(radius * Vector((reach * cos(a), reach * sin(a), z - center))) for a in angles]

    even, odd = range(0, 16, 2), range(1, 16, 2)
    table = ring(even, table_reach, half_girdle + crown * (1 - table_reach))
    stars = ring(odd, star_reach / cos(pi / 8), half_girdle + crown * (1 - star_reach))
    upper, lower = ring(range(16), 1, half_girdle), ring(range(16), 1, -half_girdle)
    halves = ring(odd, lower_reach / cos(pi / 8), -half_girdle - pavilion * (1 - lower_reach))
    culet, = ring([0], 0, -half_girdle - pavilion)

    bm.faces.new(table)
    for k in range(8):
        i, j, next_i = 2 * k, 2 * k + 1, (2 * k + 2) % 16
        bm.faces.new((table[k], stars[k], table[(k + 1) % 8]))
        bm.faces.new((table[k], stars[k - 1], upper[i], stars[k]))
        bm.faces.new((culet, halves[k], lower[i], halves[k - 1]))
        for a, b in ((i, j), (j, next_i)):
            bm.faces.new((stars[k], upper[a], upper[b]))
            bm.faces.new((upper[a], lower[a], lower[b], upper[b]))
            bm.faces.new((halves[k], lower[b], lower[a]))
    return bpy.data.objects.new("Gem", new_mesh("Gem", bm, smooth=False))


# Everything else

def glass(roughness):
    material = bpy.data.materials.new("Frosted Glass" if roughness else "Clear Glass")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (250, 0)
    bsdf = tree.nodes.new("ShaderNodeBsdfGlass")
    bsdf.distribution = 'BECKMANN'
    bsdf.inputs["Color"].default_value = (1, 1, 1, 1)
    bsdf.inputs["Roughness"].default_value = roughness
    bsdf.inputs["IOR"].default_value = 1.5
    tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    return material


def etched():
    """A thin pane whose inner side is frosted but for stripes (de Rousiers et al. 2012, Fig. 16); its picture
    is stored in the .blend."""
    material = glass(0.02)
    material.name = "Etched"
    width = 256
    image = bpy.data.images.new("Stripes", width, 1, float_buffer=True, is_data=True)
    image.pixels.foreach_set([value for x in range(width)
                              for value in 3 * [0.1 + 0.5 * abs(sin(4 * pi * x / width))] + [1.0]])
    image.pack()
    material.verglas.kind = 'PANE'
    material.verglas.inner_image = image
    return material


def lacquer():
    """Gold under a clear layer."""
    material = glass(0.0)
    material.name = "Lacquer"
    tree = material.node_tree
    output = next(node for node in tree.nodes if node.type == 'OUTPUT_MATERIAL')
    tree.nodes.remove(next(node for node in tree.nodes if node.type == 'BSDF_GLASS'))
    bsdf = tree.nodes.new("ShaderNodeBsdfGlossy")
    bsdf.distribution = 'BECKMANN'
    bsdf.inputs["Roughness"].default_value = 0.4
    tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    material.verglas.kind, material.verglas.metal = 'COATED', 'GOLD'
    return material


def coated_grid():
    """ENDF Fig. 18: 4 x 4 spheres, the outer side's roughness by row, the base's by column."""
    roughnesses = [min((2 / kappa) ** 0.25, 1.0) for kappa in (1e6, 1e3, 10, 1)]
    bm = bmesh.new()
    for row in range(4):
        for column in range(4):
            made = bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=0.24)
            bmesh.ops.translate(bm, verts=made["verts"], vec=(0.55 * column - 0.825, 0, 0.55 * row - 0.825))
            for face in {face for vertex in made["verts"] for face in vertex.link_faces}:
                face.material_index = 4 * row + column
    grid = bpy.data.objects.new("Coated Grid", new_mesh("Coated Grid", bm, smooth=True))
    for outer in roughnesses:
        for base in roughnesses:
            material = lacquer()
            material.verglas.metal = 'COPPER'
            material.verglas.outer_roughness = outer
            node = next(node for node in material.node_tree.nodes if node.type == 'BSDF_GLOSSY')
            node.inputs["Roughness"].default_value = base
            grid.data.materials.append(material)
    return grid


def pane():
    """A sheet of 4.4 x 4.4 that covers the picture, upright, its front to the camera."""
    bm = bmesh.new()
    bm.loops.layers.uv.new()
    bmesh.ops.create_grid(bm, x_segments=1, y_segments=1, size=2.2, calc_uvs=True)
    bmesh.ops.rotate(bm, verts=bm.verts, matrix=Matrix.Rotation(radians(90), 3, 'X'))
    return bpy.data.objects.new("Pane", new_mesh("Pane", bm, smooth=False, closed=False))


def lamp():
    """A glowing ball behind the pane."""
    data = bpy.data.lights.new("Lamp", 'POINT')
    data.energy, data.color, data.shadow_soft_size = 300, (1.0, 0.7, 0.4), 0.4
    lamp = bpy.data.objects.new("Lamp", data)
    lamp.location = (0.4, 1.5, 0.3)
    return lamp


def land_and_water():
    """Glass that is rough where land is and smoother on water: as Blinn-Phong's exponents 4.2 and 100."""
    land, water = ((2 / (exponent + 2)) ** 0.25 for exponent in (4.2, 100))
    material = glass(water)
    material.name = "Land and Water"
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(str(FOLDER / LAND_MASK))
    texture.image.filepath = "//" + LAND_MASK
    texture.image.colorspace_settings.name = "Non-Color"
    texture.location = (-480, 0)
    roughness = tree.nodes.new("ShaderNodeMapRange")
    roughness.inputs["To Min"].default_value = water
    roughness.inputs["To Max"].default_value = land
    roughness.location = (-200, 0)
    bsdf = next(node for node in tree.nodes if node.type == 'BSDF_GLASS')
    tree.links.new(texture.outputs["Color"], roughness.inputs["Value"])
    tree.links.new(roughness.outputs["Result"], bsdf.inputs["Roughness"])
    return material


def park():
    image = bpy.data.images.load(str(FOLDER / ENVIRONMENT))
    image.filepath = "//" + ENVIRONMENT
    return world(image, ENVIRONMENT_ROTATION)


def sun():
    """A sun 1.4 degrees wide along +Y, and nothing else; its picture is stored in the .blend."""
    width, height = 512, 256
    image = bpy.data.images.new("Sun", width, height, float_buffer=True)
    pixels = [0.0, 0.0, 0.0, 1.0] * (width * height)
    for texel in (y * width + x for x in (127, 128) for y in (127, 128)):
        pixels[4 * texel:4 * texel + 3] = [1e4] * 3
    image.pixels.foreach_set(pixels)
    image.pack()
    return world(image, 0.0)


def world(image, rotation):
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    names = ("TexCoord", "Mapping", "TexEnvironment", "Background", "OutputWorld")
    coordinates, mapping, texture, background, output = (tree.nodes.new("ShaderNode" + n) for n in names)
    for i, node in enumerate((coordinates, mapping, texture, background, output)):
        node.location = (i * 220 - (100 if i < 2 else 0), 0)
    output.location.x += 80
    background.location.x += 80
    mapping.inputs["Rotation"].default_value = (0, 0, rotation)
    texture.image = image
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    return world


def camera():
    data = bpy.data.cameras.new("Camera")
    data.lens = 50
    camera = bpy.data.objects.new("Camera", data)
    camera.location = (0, -5.2, 0.3)
    camera.rotation_euler = (radians(87), 0, 0)
    return camera


def select_engine(scene):
    """Stores Verglas as the scene's engine, whether its add-on is enabled here or not."""
    try:
        scene.render.engine = ENGINE
    except TypeError:
        stand_in = type("StandIn", (bpy.types.RenderEngine,), {"bl_idname": ENGINE, "bl_label": "Verglas"})
        bpy.utils.register_class(stand_in)
        scene.render.engine = ENGINE


def arrange_windows():
    """The 3D views look through the camera; the file browsers forget this machine's home."""
    for screen in bpy.data.screens:
        for space in (area.spaces.active for area in screen.areas):
            if space.type == 'VIEW_3D':
                space.region_3d.view_perspective = 'CAMERA'
            elif space.type == 'FILE_BROWSER' and space.params:
                space.params.directory = b"//"


class Sample(NamedTuple):
    make_object: Callable
    materials: tuple  # a roughness or what makes the material, each
    rotation: tuple = (0, 0, 0)
    make_world: Callable = park
    make_lamp: Callable = None


SCENES = {
    "monkey": Sample(monkey, (0.35,)),
    "sphere": Sample(sphere, (0.35,)),
    "lens": Sample(lens, (0.3,)),
    "bottle": Sample(bottle, (0.35,)),
    "slab": Sample(slab, (0.4,), (0, 0, radians(30))),
    "sunlit_slab": Sample(sunlit_slab, (0.35, 0.0), make_world=sun),
    "globe": Sample(globe, (land_and_water,), (0, 0, radians(60))),
    "pane": Sample(pane, (etched,), make_lamp=lamp),
    "coated": Sample(kitten, (lacquer,), (0, 0, radians(-18))),
    "coated_grid": Sample(coated_grid, ()),
    "gem": Sample(gem, (0.25,), (radians(42), radians(-12), 0)),
}


def make(name):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert addon_utils.enable("verglas"), "The add-on 'verglas' has to be installed: ./verglas setup"
    sample = SCENES[name]
    scene = bpy.context.scene
    object = sample.make_object()
    if object.name not in scene.collection.all_objects:
        scene.collection.objects.link(object)
    object.rotation_euler = sample.rotation
    for material in sample.materials:
        object.data.materials.append(material() if callable(material) else glass(material))
    if sample.make_lamp:
        scene.collection.objects.link(sample.make_lamp())
    scene.world = sample.make_world()
    scene.camera = camera()
    scene.collection.objects.link(scene.camera)

    scene.render.resolution_x = scene.render.resolution_y = 512
    scene.render.resolution_percentage = 100
    scene.render.filepath = f"//{name}_"
    scene.view_settings.view_transform = 'Standard'
    if hasattr(scene, "cycles"):  # for comparison; Debian's Blender comes without OpenImageDenoise
        scene.cycles.samples = 64
        scene.cycles.use_denoising = False
    bpy.context.view_layer.objects.active = object
    select_engine(scene)
    arrange_windows()
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / f"{name}.blend"), compress=True)

    mesh = object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    mesh.calc_loop_triangles()
    print(f"{name}: {len(mesh.loop_triangles)} triangles")


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    for name in arguments or SCENES:
        make(name)
