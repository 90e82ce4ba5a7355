# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in an evaluated scene that is drawn: objects and their instances."""

from collections.abc import Hashable
from typing import NamedTuple

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Warn
from . import lights, materials, meshes, painting, tangents, viewports
from .readings import Reading, Readings

UNSUPPORTED = {
    'CURVES': "Hair curves",
    'GPENCIL': "Grease pencil",
    'GREASEPENCIL': "Grease pencil",
    'POINTCLOUD': "Point cloud",
    'VOLUME': "Volume",
}
"""Object types that other engines render and this one doesn't yet."""


def add_objects(scene: core.Scene, depsgraph: bpy.types.Depsgraph, warn: Warn,
                space: bpy.types.SpaceView3D | None = None, with_lights: bool = True) -> None:
    """Adds all that the view layer renders or, with a space, that this viewport shows. Curves, surfaces, text
    and metaballs come as instances of type MESH as well, made by Blender; only those count."""
    sync = _Sync(scene, depsgraph, warn, with_lights)
    for instance in depsgraph.object_instances:
        if instance.show_self:
            sync.add(instance, space)
    sync.finish()


class _Painted(NamedTuple):
    """What varies of a material, on the triangles of a slot."""
    warnings: tuple[str, ...]
    roughness: painting.Painting | None
    inner_roughness: painting.Painting | None
    normals: painting.Painting | None
    tangents: np.ndarray | None
    """(T, 3, 4), where the normals are in tangent space"""
    heights: painting.Painting | None

    @property
    def coordinates(self) -> dict[str, np.ndarray]:
        """By their names in meshes.TEXTURE_COORDINATES."""
        paintings = {"uvs": self.roughness or self.inner_roughness, "normal_uvs": self.normals,
                     "height_uvs": self.heights}
        found = {name: painted.uvs for name, painted in paintings.items() if painted is not None}
        return found if self.tangents is None else {**found, "tangents": self.tangents}

    @property
    def textures(self) -> tuple[core.Texture | core.VectorTexture | None, ...]:
        paintings = (self.roughness, self.inner_roughness, self.normals, self.heights)
        return tuple(painted and painted.texture for painted in paintings)


_NOT_PAINTED = _Painted((), None, None, None, None, None)


class _Model(NamedTuple):
    """What instances of an object have in common."""
    mesh: core.Mesh
    materials: list[int]
    """as core.Scene.add_object's"""


class _Sync:
    """One pass over the instances, with what they share."""

    def __init__(self, scene: core.Scene, depsgraph: bpy.types.Depsgraph, warn: Warn, with_lights: bool):
        self.scene = scene
        self.with_lights = with_lights
        self.warn = warn
        self.depsgraph = depsgraph
        self.material_override = depsgraph.view_layer_eval.material_override
        self.readings = Readings(depsgraph)
        self.models: dict[tuple[str, int], _Model | None] = {}
        """by the object's name with library and its mesh's address, which holds while the depsgraph isn't
        evaluated again; None where there is nothing to draw"""
        self.glasses: dict[str, materials.Glass | None] = {}
        """by the material's name with library; None where it isn't glass"""
        self.material_indices: dict[Hashable, int] = {}
        """by the material and its textures"""

    def add(self, instance: bpy.types.DepsgraphObjectInstance, space: bpy.types.SpaceView3D | None) -> None:
        obj = instance.object
        is_shown = space is None or viewports.shows(space, obj)
        if obj.type in UNSUPPORTED and is_shown:
            self.warn(f"{UNSUPPORTED[obj.type]} '{obj.name}' isn't supported yet; it is left out.")
        if obj.type == 'LIGHT' and self.with_lights and is_shown:
            lights.add(self.scene, obj, np.array(instance.matrix_world), self.warn)
        if obj.type != 'MESH':
            return
        self.readings.touch(obj)
        if not is_shown:
            return
        key = (obj.name_full, obj.data.as_pointer())
        if key not in self.models:
            self.models[key] = self._model(obj)
        model = self.models[key]
        if model is None:
            return
        matrix = np.array(instance.matrix_world, np.float32)
        if self._has_volume(obj, matrix):
            self.scene.add_object(obj.name, model.mesh, matrix, model.materials)

    def finish(self) -> None:
        self.readings.finish()

    def _model(self, obj: bpy.types.Object) -> _Model | None:
        if not obj.visible_camera:
            return None
        self._warn_of_features(obj)
        reading = self.readings.of(obj)
        if len(reading.arrays.triangles) == 0:
            return None
        keys_of_slots = self._materials(obj, reading.arrays.used_slots)
        if not keys_of_slots:
            return None
        painted = {slot: self._paint(obj, reading, slot, key) for slot, key in keys_of_slots.items()}
        indices = {slot: self._index(key, painted[slot]) for slot, key in keys_of_slots.items()}
        # Triangles of the slots that aren't glass are not in the mesh: any index does for those
        table = [indices.get(slot, 0) for slot in range(max(indices) + 1)]
        return _Model(self._core_mesh(obj, reading, keys_of_slots, painted), table)

    def _has_volume(self, obj: bpy.types.Object, matrix: np.ndarray) -> bool:
        """Whether the object's transform leaves glass to look through."""
        determinant = np.linalg.det(matrix[:3, :3].astype(float))
        if determinant != 0.0 and np.isfinite(matrix).all():
            return True
        self.warn(f"Object '{obj.name}' is scaled to 0 or has a transform that is no number; it is left out.")
        return False

    def _core_mesh(self, obj: bpy.types.Object, reading: Reading, keys_of_slots: dict[int, str],
                   painted: dict[int, _Painted]) -> core.Mesh:
        by_slot = {slot: each.coordinates for slot, each in painted.items()}
        textured = frozenset(self._paint_key(obj, slot, keys_of_slots[slot])
                             for slot, found in by_slot.items() if found)
        slots = frozenset(keys_of_slots)

        def make() -> core.Mesh:
            by_name = {name: {slot: found[name] for slot, found in by_slot.items() if name in found}
                       for name in meshes.TEXTURE_COORDINATES}
            return meshes.to_core(meshes.name_of(obj), reading.arrays, slots,
                                  {name: found for name, found in by_name.items() if found})
        mesh = reading.get((meshes.name_of(obj), slots, textured), make)
        for sentence in mesh.warnings:
            self.warn(meshes.title(obj) + sentence.removeprefix(f"Mesh '{mesh.name}'"))
        return mesh

    def _paint_key(self, obj: bpy.types.Object, slot: int, material: str) -> Hashable:
        """What a _Painted depends on beside the mesh; the title is for its warnings."""
        return slot, material, self.glasses[material].painting_key, meshes.title(obj)

    def _paint(self, obj: bpy.types.Object, reading: Reading, slot: int, material: str) -> _Painted:
        def make() -> _Painted:
            warnings: list[str] = []
            surface = meshes.Surface(obj, reading.arrays, slot, warnings.append)
            normals, of_tangents = self._normals(surface, glass, warnings.append)
            heights = glass.relief.heights
            roughness, inner_roughness = painting.paint_both(
                glass.roughness_map, glass.inner_roughness_map, surface, glass.bake_resolution)
            painted = heights and painting.paint(heights.heights, surface, glass.bake_resolution,
                                                 has_slopes=True)
            return _Painted(tuple(warnings), roughness, inner_roughness, normals, of_tangents, painted)

        glass = self.glasses[material]
        maps = (glass.roughness_map, glass.inner_roughness_map, *glass.relief)
        if all(each is None for each in maps):
            return _NOT_PAINTED
        painted = reading.get(self._paint_key(obj, slot, material), make)
        for sentence in painted.warnings:
            self.warn(sentence)
        return painted

    @staticmethod
    def _normals(surface: meshes.Surface, glass: materials.Glass,
                 warn: Warn) -> tuple[painting.Painting | None, np.ndarray | None]:
        """Of a normal map: its colours, and its tangents, which only a map in tangent space has."""
        normals = glass.relief.normals
        if normals is None:
            return None, None
        name, of_tangents = normals.uv_map, None
        if normals.space == 'TANGENT':
            if not surface.has_uv_map(name):
                warn(f"{surface.title} has no UV map{f' {name!r}' if name else ''} for the normal map of "
                     f"material '{glass.name}'; it keeps its own normals.")
                return None, None
            of_tangents = tangents.of_surface(surface, name)
        return painting.paint(normals.colors, surface, glass.bake_resolution), of_tangents

    def _index(self, material: str, painted: _Painted) -> int:
        """The core's index of a material, with the textures of what varies."""
        key = (material, painted.textures)
        if key not in self.material_indices:
            glass = self.glasses[material]
            (glass.roughness_texture, glass.layer.roughness_texture,
             glass.normal_map.texture, glass.bump_map.height) = painted.textures
            self.material_indices[key] = self.scene.add_material(glass)
        return self.material_indices[key]

    def _materials(self, obj: bpy.types.Object, used_slots: tuple[int, ...]) -> dict[int, str]:
        """For each used slot that is glass the key of its material. Slots past the object's last take
        that one, as in Cycles."""
        slots = obj.material_slots
        found = {}
        for slot in used_slots:
            material = slots[min(slot, len(slots) - 1)].material if len(slots) else None
            found[slot] = self._material(obj, self.material_override or material)
        return {slot: key for slot, key in found.items() if key is not None}

    def _material(self, obj: bpy.types.Object, material: bpy.types.Material | None) -> str | None:
        """The key of a material; None where it isn't glass."""
        if material is None:
            self.warn(f"Object '{obj.name}' has no material; it is rendered as glass of roughness 0.25.")
        key = material.name_full if material else ""
        if key not in self.glasses:
            check_images = self.depsgraph.mode == 'RENDER'
            self.glasses[key] = (materials.from_blender(material, self.warn, check_images) if material
                                 else materials.default_glass(""))
        if self.glasses[key] is None:
            self.warn(f"Object '{obj.name}': material '{material.name}' has no glass in it; opaque materials "
                      "aren't supported yet, so its faces are left out.")
            return None
        return key

    def _warn_of_features(self, obj: bpy.types.Object) -> None:
        if obj.is_holdout:
            self.warn(f"Object '{obj.name}' is a holdout, which isn't supported yet; that is ignored.")
        particles = (system.settings for system in obj.particle_systems)
        if any(settings.type == 'HAIR' and settings.render_type == 'PATH' for settings in particles):
            self.warn(f"Object '{obj.name}' has hair, which isn't supported yet; it is left out.")
