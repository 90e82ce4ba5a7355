# SPDX-License-Identifier: GPL-3.0-or-later
"""What each shader node calculates, with the meaning that Cycles gives to it."""

from collections.abc import Callable

import bpy
import numpy as np
from mathutils import Euler

from . import images, nodes, noise, operations, procedural, voronoi
from .expressions import (
    Compiler, Expression, Function, Image, NodeFunction, Placement, Points, Reader, Unsupported,
    converted, once, own_array,
)

TABLE_SIZE = 256
"""Entries of Cycles' tables for colour ramps and curves."""


def expression_of(found: nodes.Input, check_images: bool = False, kind: str = 'VALUE') -> Expression:
    """What an input takes, as a number or, kind 'RGBA', as a colour. check_images: as images.picture's.
    Raises Unsupported."""
    compiler = Compiler(_NODES, check_images)
    evaluate = compiler.value(found, kind)
    output = found.source().output
    return Expression(evaluate, (kind, *compiler.keys), frozenset(compiler.leaves),
                      frozenset(compiler.placements), tuple(compiler.placed),
                      output is not None and output.node.type == 'TEX_IMAGE'
                      and not any(image.picture.is_srgb for image in compiler.placed),
                      (3,) if kind == 'RGBA' else ())


def expression_of_image(image: bpy.types.Image, check_images: bool) -> Expression:
    """An image's brightness over the default UV map. check_images: as images.picture's. Raises
    images.Unreadable."""
    picture = images.picture(image, check_images)
    placed = Image(picture, 'EXTEND' if image.source == 'TILED' else 'REPEAT', 'Linear')
    placement = Placement('', ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))).within(picture)
    rgba = _at_placement(placed, placement,
                         lambda uv: images.sample(picture.rgba, uv, placed.extension, placed.interpolation))

    def evaluate(points: Points) -> np.ndarray:
        color = rgba(points)[:, :3]
        return (images.linear_from_srgb(color) if picture.is_srgb else color) @ nodes.LUMINANCE
    return Expression(evaluate, ('VALUE', picture.key, placement), frozenset(), frozenset({placement}),
                      (placed,), not picture.is_srgb)


# Inputs and coordinates

def _own(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    own = own_array(output)
    reader.compiler.keys.append(own.tobytes())
    return lambda points: own


def _texture_coordinate(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    leaf = {'UV': ('UV', ''), 'Generated': ('GENERATED', ''), 'Object': ('OBJECT', ''),
            'Normal': ('NORMAL', '')}.get(output.identifier)
    node = reader.node
    if leaf is None or node.from_instancer or (leaf[0] == 'OBJECT' and node.object is not None):
        raise Unsupported(node, f"has an output {output.name} that isn't supported yet" if leaf is None else
                          "takes coordinates of another object, which isn't supported yet")
    return reader.compiler.leaf(leaf)


def _uv_map(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    if reader.node.from_instancer:
        raise Unsupported(reader.node, "takes coordinates of another object, which isn't supported yet")
    return reader.compiler.leaf(('UV', reader.node.uv_map))


def _attribute(reader: Reader, output: bpy.types.NodeSocket, wanted: str) -> Function:
    node = reader.node
    if getattr(node, "attribute_type", 'GEOMETRY') != 'GEOMETRY':
        raise Unsupported(node, "isn't an attribute of the geometry, and others aren't supported yet")
    name = node.layer_name if node.type == 'VERTEX_COLOR' else node.attribute_name
    kinds = {'Fac': 'FACTOR', 'Factor': 'FACTOR', 'Alpha': 'ALPHA'}
    is_gray = output.type == 'RGBA' and wanted == 'VALUE'
    kind = kinds.get(output.identifier, 'GRAY' if is_gray else 'COLOR')
    reader.kind = 'VALUE' if is_gray else output.type
    if node.type == 'VERTEX_COLOR':
        name = name or "*"  # the mesh's own choice
    return reader.compiler.leaf((kind, name))


def _mapping(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    kind = reader.node.vector_type
    vector, rotation, scale = (reader.vector(name) for name in ("Vector", "Rotation", "Scale"))
    location = reader.vector("Location") if kind in {'POINT', 'TEXTURE'} else lambda points: np.zeros(3)
    return lambda points: operations.mapped(kind, vector(points), location(points), rotation(points),
                                            scale(points))


def _placement(reader: Reader, found: nodes.Input) -> Placement | None:
    """Where coordinates come from a UV map through Mapping nodes with constant inputs."""
    output, end = found.source()
    matrix = np.eye(4)
    while output is not None and output.node.type == 'MAPPING':
        mapping = Reader(reader.compiler, output.node, end.groups)
        step = _matrix_of(mapping)
        if step is None:
            return None
        matrix = matrix @ step
        output, end = mapping.input("Vector").source()
    if output is None:
        uv_map = '' if end.socket.node == reader.node and end.socket.identifier == "Vector" else None
    elif output.node.type == 'UVMAP' and not output.node.from_instancer:
        uv_map = output.node.uv_map
    else:
        is_default = (output.node.type == 'TEX_COORD' and output.identifier == 'UV'
                      and not output.node.from_instancer)
        uv_map = '' if is_default else None
    if uv_map is None:
        return None
    return Placement.of_matrix(uv_map, matrix)


def _matrix_of(mapping: Reader) -> np.ndarray | None:
    """(4, 4) of one Mapping node; None where it isn't one."""
    kind = mapping.node.vector_type
    rotation, scale = mapping.constant("Rotation"), mapping.constant("Scale")
    location = mapping.constant("Location") if kind in {'POINT', 'TEXTURE'} else np.zeros(3)
    if kind == 'NORMAL' or rotation is None or scale is None or location is None:
        return None
    matrix = np.eye(4)
    turn = np.array(Euler(rotation, 'XYZ').to_matrix(), float)
    if kind == 'TEXTURE':
        inverse = np.divide(1.0, scale, out=np.zeros(3), where=scale != 0.0)
        matrix[:3, :3] = np.diag(inverse) @ turn.T
        matrix[:3, 3] = matrix[:3, :3] @ -location
    else:
        matrix[:3, :3] = turn @ np.diag(scale)
        matrix[:3, 3] = location
    return matrix


# Images

def _image_texture(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    image = _image_of(reader)
    rgba = _looked_up(reader, image)
    if output.identifier == 'Alpha':
        return lambda points: rgba(points)[:, 3]
    is_separated = image.picture.is_associated and reader.node.outputs['Alpha'].is_linked

    def evaluate(points: Points) -> np.ndarray:
        color = operations.unassociated(rgba(points)) if is_separated else rgba(points)[:, :3]
        if not image.picture.is_srgb:
            return color
        are_bytes = image.is_at_texels(points) and not is_separated
        return images.linear_from_srgb_bytes(color) if are_bytes else images.linear_from_srgb(color)
    return evaluate


def _image_of(reader: Reader) -> Image:
    node = reader.node
    if node.image is None:
        raise Unsupported(node, "has no image")
    try:
        picture = images.picture(node.image, reader.compiler.check_images)
    except images.Unreadable as fault:
        raise Unsupported(node, str(fault)) from fault
    reader.compiler.keys.append(picture.key)
    return Image(picture, 'EXTEND' if node.image.source == 'TILED' else node.extension, node.interpolation)


def _looked_up(reader: Reader, image: Image) -> Function:
    """(N, 4) of the image, as its picture holds it."""
    key = ("image", reader.node.as_pointer())

    def look_up(uv: np.ndarray) -> np.ndarray:
        """uv: over all tiles"""
        return images.sample(image.picture.rgba, uv, image.extension, image.interpolation)

    def look_up_tile(p: np.ndarray) -> np.ndarray:
        uv = np.atleast_2d(p)[:, :2]
        return look_up((uv - image.picture.origin) / image.picture.span)

    if reader.node.projection == 'FLAT':
        placement = _placement(reader, reader.input("Vector"))
        if placement is not None:
            return once(key, _placed(reader, image, placement.within(image.picture), look_up))
        vector = reader.coordinates(('UV', ''))
        return once(key, lambda points: look_up_tile(vector(points)))
    vector = reader.coordinates(('UV', ''))
    if reader.node.projection != 'BOX':
        project = {'SPHERE': operations.sphere_uv, 'TUBE': operations.tube_uv}[reader.node.projection]
        return once(key, lambda points: look_up_tile(project(vector(points))))
    normal, blend = reader.compiler.leaf(('NORMAL', '')), reader.node.projection_blend
    return once(key, lambda points: operations.box_projected(
        look_up_tile, np.atleast_2d(vector(points)), normal(points), blend))


def _placed(reader: Reader, image: Image, placement: Placement,
            look_up: Callable[[np.ndarray], np.ndarray]) -> Function:
    compiler = reader.compiler
    compiler.placements.add(placement)
    compiler.placed.append(image)
    compiler.keys.append(placement)
    return _at_placement(image, placement, look_up)


def _at_placement(image: Image, placement: Placement,
                  look_up: Callable[[np.ndarray], np.ndarray]) -> Function:
    def evaluate(points: Points) -> np.ndarray:
        if points.image_uv is None:
            return look_up(placement.apply(points.leaf(('UV', placement.uv_map))))
        if image.is_at_texels(points):
            return image.picture.rgba[points.texels.rows].reshape(-1, 4)
        return look_up(points.image_uv())
    return evaluate


# Conversions

def _ramp(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    ramp = reader.node.color_ramp
    if len(ramp.elements) == 0:
        raise Unsupported(reader.node, "has no color")
    table = np.array([ramp.evaluate(i / (TABLE_SIZE - 1)) for i in range(TABLE_SIZE)], np.float32)
    reader.compiler.keys.append(table.tobytes())
    is_smooth = ramp.interpolation != 'CONSTANT'
    channels = slice(0, 3) if output.type == 'RGBA' else 3
    factor = reader.number(0)
    return lambda points: operations.table_value(table, factor(points), is_smooth)[..., channels]


def _curves(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    mapping = reader.node.mapping
    mapping.initialize()
    ends = [point.location.x for curve in mapping.curves for point in curve.points]
    lower, upper = min(ends, default=0.0), max(ends, default=1.0)
    inputs = np.linspace(lower, upper, TABLE_SIZE)
    is_float = reader.node.type == 'CURVE_FLOAT'
    table = np.array([_curve_values(mapping, x, is_float) for x in inputs], np.float32)
    reader.compiler.keys.append((lower, upper, mapping.extend, table.tobytes()))
    extrapolates = mapping.extend == 'EXTRAPOLATED'
    factor, value = reader.number(0), reader.number(1) if is_float else reader.color(1)

    def evaluate(points: Points) -> np.ndarray:
        x = value(points)
        place = (x - lower) / max(upper - lower, 1e-12)
        curved = operations.curved(table, place, extrapolates)
        t = factor(points)
        return operations.mix(x, curved, t if is_float else t[..., None])
    return evaluate


def _curve_values(mapping: bpy.types.CurveMapping, x: float, is_float: bool) -> tuple[float, ...]:
    """(1,) or (3,): the combined curve, then that of each channel."""
    if is_float:
        return (mapping.evaluate(mapping.curves[0], x),)
    combined = mapping.evaluate(mapping.curves[3], x)
    return tuple(mapping.evaluate(curve, combined) for curve in mapping.curves[:3])


def _math(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    operation = operations.MATH.get(reader.node.operation)
    if operation is None:
        raise Unsupported(reader.node, f"calculates '{reader.node.operation}', which isn't supported yet")
    count = operation.__code__.co_argcount
    inputs = [reader.number(i) for i in range(count)]
    return _clamped(reader.node.use_clamp, lambda points: operation(*(each(points) for each in inputs)))


def _vector_math(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    operation = operations.VECTOR_MATH.get(reader.node.operation)
    if operation is None:
        raise Unsupported(reader.node, f"calculates '{reader.node.operation}', which isn't supported yet")
    if reader.node.operation == 'SCALE':
        vector, scale = reader.vector(0), reader.number("Scale")
        return lambda points: vector(points) * scale(points)[..., None]
    inputs = [reader.vector(i) for i in range(operation.__code__.co_argcount)]
    return lambda points: operation(*(each(points) for each in inputs))


def _clamped(is_clamped: bool, function: Function) -> Function:
    return (lambda points: np.clip(function(points), 0.0, 1.0)) if is_clamped else function


def _map_range(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node = reader.node
    if getattr(node, "data_type", 'FLOAT') != 'FLOAT':
        raise Unsupported(node, "maps vectors, which isn't supported yet")
    value, *ends = (reader.number(i) for i in range(5))
    steps = reader.number("Steps")
    kind, clamps = node.interpolation_type, node.clamp
    return lambda points: operations.map_range(kind, clamps, value(points), *(end(points) for end in ends),
                                               steps(points))


def _clamp(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    value, lower, upper = (reader.number(i) for i in range(3))
    swaps = reader.node.clamp_type == 'RANGE'

    def evaluate(points: Points) -> np.ndarray:
        x, a, b = value(points), lower(points), upper(points)
        if swaps:
            a, b = np.minimum(a, b), np.maximum(a, b)
        return np.minimum(np.maximum(x, a), b)
    return evaluate


def _mix_rgb(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    return _blend(reader, reader.number(0), reader.color(1), reader.color(2), reader.node.use_clamp)


def _mix(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node, kind = reader.node, reader.node.data_type
    is_vector_factor = kind == 'VECTOR' and node.factor_mode == 'NON_UNIFORM'
    factor = reader.vector("Factor_Vector") if is_vector_factor else reader.number("Factor_Float")
    factor = _clamped(node.clamp_factor, factor)
    if kind == 'RGBA':
        return _blend(reader, factor, reader.color("A_Color"), reader.color("B_Color"), node.clamp_result)
    if kind == 'FLOAT':
        a, b = reader.number("A_Float"), reader.number("B_Float")
        return lambda points: operations.mix(a(points), b(points), factor(points))
    if kind != 'VECTOR':
        raise Unsupported(node, f"mixes {kind.lower()}s, which isn't supported yet")
    a, b = reader.vector("A_Vector"), reader.vector("B_Vector")
    if is_vector_factor:
        return lambda points: operations.mix(a(points), b(points), factor(points))
    return lambda points: operations.mix(a(points), b(points), factor(points)[..., None])


def _blend(reader: Reader, factor: Function, first: Function, second: Function, clamps: bool) -> Function:
    blend = operations.BLEND.get(reader.node.blend_type)
    if blend is None:
        raise Unsupported(reader.node, f"blends by '{reader.node.blend_type}', which isn't supported yet")
    if reader.node.type == 'MIX_RGB':
        factor = _clamped(True, factor)
    return _clamped(clamps, lambda points: blend(first(points), second(points), factor(points)[..., None]))


def _invert(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    factor, color = reader.number(0), reader.color(1)
    return lambda points: operations.mix(color(points), 1.0 - color(points), factor(points)[..., None])


def _gamma(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    color, gamma = reader.color(0), reader.number(1)

    def evaluate(points: Points) -> np.ndarray:
        base = color(points)
        return np.where(base > 0.0, np.maximum(base, 1e-30) ** gamma(points)[..., None], base)
    return evaluate


def _bright_contrast(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    color, bright, contrast = reader.color(0), reader.number(1), reader.number(2)

    def evaluate(points: Points) -> np.ndarray:
        b, c = bright(points)[..., None], contrast(points)[..., None]
        return np.maximum((1.0 + c) * color(points) + b - 0.5 * c, 0.0)
    return evaluate


def _to_bw(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    color = reader.color(0)
    return lambda points: color(points) @ nodes.LUMINANCE


_FROM_RGB = {'RGB': lambda color: color, 'HSV': operations.hsv_from_rgb, 'HSL': operations.hsl_from_rgb}
_TO_RGB = {'RGB': lambda color: color, 'HSV': operations.rgb_from_hsv, 'HSL': operations.rgb_from_hsl}
"""By the color model in which a node separates or combines."""


def _separate(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    whole = reader.vector(0) if reader.node.type == 'SEPXYZ' else reader.color(0)
    convert = _FROM_RGB[_color_model(reader.node)]
    channel = list(reader.node.outputs).index(output)
    return lambda points: convert(whole(points))[..., channel]


def _combine(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    convert = _TO_RGB[_color_model(reader.node)]
    parts = [reader.number(i) for i in range(3)]
    return lambda points: convert(np.stack(np.broadcast_arrays(*(part(points) for part in parts)), axis=-1))


def _color_model(node: bpy.types.Node) -> str:
    return 'HSV' if node.type in {'SEPHSV', 'COMBHSV'} else getattr(node, "mode", 'RGB')


# Textures that are calculated

def _checker(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    vector, scale = reader.coordinates(('GENERATED', '')), reader.number("Scale")
    colors = [reader.color("Color1"), reader.color("Color2")]

    def evaluate(points: Points) -> np.ndarray:
        factor = procedural.checker(vector(points) * scale(points)[..., None])
        if output.identifier == 'Fac':
            return factor
        return operations.mix(colors[1](points), colors[0](points), factor[..., None])
    return evaluate


def _gradient(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    vector, kind = reader.coordinates(('GENERATED', '')), reader.node.gradient_type
    return _grey(output, lambda points: procedural.gradient(kind, vector(points)))


def _grey(output: bpy.types.NodeSocket, function: Function) -> Function:
    return function if output.type == 'VALUE' else converted(function, 'VALUE', output.type)


def _magic(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    vector = reader.coordinates(('GENERATED', ''))
    scale, distortion = reader.number("Scale"), reader.number("Distortion")
    depth = reader.node.turbulence_depth

    def evaluate(points: Points) -> np.ndarray:
        color = procedural.magic(vector(points) * scale(points)[..., None], distortion(points), depth)
        return color if output.type == 'RGBA' else color.mean(axis=-1)
    return evaluate


def _noise(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node = reader.node
    if getattr(node, "noise_type", 'FBM') != 'FBM':
        raise Unsupported(node, f"is of type '{node.noise_type}', which isn't supported yet")
    normalize = getattr(node, "normalize", True)
    place = _scaled_place(reader, node.noise_dimensions)
    names = ("Detail", "Roughness", "Lacunarity", "Distortion")
    numbers = {name.lower(): reader.number(name) for name in names if reader.has(name)}
    is_color = output.type == 'RGBA'

    def evaluate(points: Points) -> np.ndarray:
        values = {name: function(points) for name, function in numbers.items()}
        return noise.noise(place(points), is_color, normalize, **values)
    return evaluate


def _scaled_place(reader: Reader, dimensions: str) -> Function:
    """(N, D) float32: coordinates of '1D', '2D', '3D' or '4D'; the first and the last have W."""
    count = int(dimensions[0])
    vector = reader.coordinates(('GENERATED', '')) if count > 1 else None
    w = reader.number("W") if count in {1, 4} else None
    scale = reader.number("Scale") if reader.has("Scale") else None

    def evaluate(points: Points) -> np.ndarray:
        parts = [vector(points)[..., :count]] if vector else []
        parts += [w(points)[..., None]] if w else []
        shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
        place = np.concatenate([np.broadcast_to(part, (*shape, part.shape[-1])) for part in parts], axis=-1)
        return np.asarray(place * scale(points)[..., None] if scale else place, np.float32)
    return evaluate


def _white_noise(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    place = _scaled_place(reader, reader.node.noise_dimensions)
    random = noise.random_color if output.type == 'RGBA' else noise.random_number
    return lambda points: random(place(points))


def _musgrave(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    kind = reader.node.musgrave_type
    place = _scaled_place(reader, reader.node.musgrave_dimensions)
    numbers = [reader.number(name) for name in ("Detail", "Dimension", "Lacunarity", "Offset", "Gain")]
    return lambda points: noise.musgrave(kind, place(points), *(each(points) for each in numbers))


def _voronoi(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node = reader.node
    if reader.has("Detail"):
        raise Unsupported(node, "has octaves in this version of Blender, which isn't supported yet")
    place = _scaled_place(reader, node.voronoi_dimensions)
    randomness = _clamped(True, reader.number("Randomness"))
    feature, metric = node.feature, 'EUCLIDEAN' if node.voronoi_dimensions == '1D' else node.distance
    if feature == 'DISTANCE_TO_EDGE':
        return lambda points: voronoi.distance_to_edge(place(points), randomness(points))
    if feature == 'N_SPHERE_RADIUS':
        return lambda points: voronoi.radius(place(points), randomness(points))
    smoothness, exponent, scale = (reader.number(name) for name in ("Smoothness", "Exponent", "Scale"))

    def cell(points: Points) -> voronoi.Cell:
        distance = voronoi.distance_of(metric, exponent(points))
        if feature == 'SMOOTH_F1':
            return voronoi.smooth(place(points), randomness(points), distance, smoothness(points))
        return voronoi.nearest(place(points), randomness(points), distance, feature == 'F2')

    def evaluate(points: Points) -> np.ndarray:
        found = cell(points)
        if output.identifier in {'Distance', 'Color'}:
            return found.distance if output.identifier == 'Distance' else found.color
        position = operations.divided(found.position, scale(points)[..., None])
        if output.identifier == 'W':
            return position[..., -1]
        flat = np.zeros((*position.shape[:-1], 3), np.float32)
        flat[..., :min(position.shape[-1], 3)] = position[..., :3]
        return flat
    return evaluate


def _wave(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node = reader.node
    kind = (node.wave_type, node.bands_direction if node.wave_type == 'BANDS' else node.rings_direction,
            node.wave_profile)
    vector, scale = reader.coordinates(('GENERATED', '')), reader.number("Scale")
    names = ("Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
    numbers = [reader.number(name) for name in names]
    return _grey(output, lambda points: procedural.wave(
        *kind, vector(points) * scale(points)[..., None], *(each(points) for each in numbers)))


def _brick(reader: Reader, output: bpy.types.NodeSocket, _) -> Function:
    node = reader.node
    vector, scale = reader.coordinates(('GENERATED', '')), reader.number("Scale")
    colors = [reader.color(name) for name in ("Color1", "Color2", "Mortar")]
    names = ("Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    numbers = [reader.number(name) for name in names]
    rows = (node.offset, node.offset_frequency, node.squash, node.squash_frequency)

    def evaluate(points: Points) -> np.ndarray:
        tint, mortar = procedural.brick(vector(points) * scale(points)[..., None],
                                        *(each(points) for each in numbers), *rows)
        if output.type != 'RGBA':
            return mortar
        first, second, between = (color(points) for color in colors)
        brick = operations.mix(first, second, tint[..., None])
        return operations.mix(brick, between, mortar[..., None])
    return evaluate


_NODES: dict[str, NodeFunction] = {
    'VALUE': _own,
    'RGB': _own,
    'TEX_COORD': _texture_coordinate,
    'UVMAP': _uv_map,
    'ATTRIBUTE': _attribute,
    'VERTEX_COLOR': _attribute,
    'MAPPING': _mapping,
    'TEX_IMAGE': _image_texture,
    'VALTORGB': _ramp,
    'CURVE_RGB': _curves,
    'CURVE_FLOAT': _curves,
    'MATH': _math,
    'VECT_MATH': _vector_math,
    'MAP_RANGE': _map_range,
    'CLAMP': _clamp,
    'MIX_RGB': _mix_rgb,
    'MIX': _mix,
    'INVERT': _invert,
    'GAMMA': _gamma,
    'BRIGHTCONTRAST': _bright_contrast,
    'RGBTOBW': _to_bw,
    'SEPRGB': _separate,
    'SEPHSV': _separate,
    'SEPXYZ': _separate,
    'SEPARATE_COLOR': _separate,
    'COMBRGB': _combine,
    'COMBHSV': _combine,
    'COMBXYZ': _combine,
    'COMBINE_COLOR': _combine,
    'TEX_CHECKER': _checker,
    'TEX_GRADIENT': _gradient,
    'TEX_MAGIC': _magic,
    'TEX_NOISE': _noise,
    'TEX_WHITE_NOISE': _white_noise,
    'TEX_MUSGRAVE': _musgrave,
    'TEX_VORONOI': _voronoi,
    'TEX_WAVE': _wave,
    'TEX_BRICK': _brick,
}
"""By a node's type."""
