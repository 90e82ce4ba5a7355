# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in an evaluated scene that is drawn: objects and their instances."""

import bpy
import numpy as np

from .. import verglas_core as core
from ..faults import Warn
from . import materials, meshes

UNSUPPORTED = {
    'CURVES': "Hair curves",
    'GPENCIL': "Grease pencil",
    'GREASEPENCIL': "Grease pencil",
    'LIGHT': "Light",
    'POINTCLOUD': "Point cloud",
    'VOLUME': "Volume",
}
"""Object types that other engines render and this one doesn't yet."""


def add_objects(scene: core.Scene, depsgraph: bpy.types.Depsgraph, warn: Warn) -> None:
    """Adds all that the view layer renders. Curves, surfaces, text and metaballs come as instances
    of type MESH as well, made by Blender; only those count."""
    sync = _Sync(scene, depsgraph, warn)
    for instance in depsgraph.object_instances:
        sync.add(instance)


class _Sync:
    """One pass over the instances, with what they share."""

    def __init__(self, scene: core.Scene, depsgraph: bpy.types.Depsgraph, warn: Warn):
        self.scene = scene
        self.warn = warn
        self.material_override = depsgraph.view_layer_eval.material_override
        self.arrays: dict[int, meshes.MeshArrays] = {}
        """by the mesh's address, which holds while the depsgraph isn't evaluated again"""
        self.core_meshes: dict[tuple[int, frozenset[int]], core.Mesh] = {}
        """by the mesh's address and its slots that are glass"""
        self.material_indices: dict[str, int | None] = {}
        """by the material's name with library; None where it isn't glass"""

    def add(self, instance: bpy.types.DepsgraphObjectInstance) -> None:
        obj = instance.object
        if not instance.show_self:
            return
        if obj.type in UNSUPPORTED:
            self.warn(f"{UNSUPPORTED[obj.type]} '{obj.name}' isn't supported yet; it is left out.")
        if obj.type != 'MESH' or not obj.visible_camera:
            return
        self._warn_of_features(obj)
        matrix = np.array(instance.matrix_world, np.float32)
        if not self._has_volume(obj, matrix):
            return
        arrays = self._arrays(obj)
        if len(arrays.triangles) == 0:
            return
        materials_of_slots = self._materials(obj, arrays.used_slots)
        slots = frozenset(slot for slot, index in materials_of_slots.items() if index is not None)
        if slots:
            # Triangles of the slots that aren't glass are not in the mesh: any index does for those
            table = [materials_of_slots.get(slot) or 0 for slot in range(max(slots) + 1)]
            self.scene.add_object(obj.name, self._core_mesh(obj, arrays, slots), matrix, table)

    def _has_volume(self, obj: bpy.types.Object, matrix: np.ndarray) -> bool:
        """Whether the object's transform leaves glass to look through."""
        if np.isfinite(matrix).all() and np.linalg.det(matrix[:3, :3].astype(float)) != 0.0:
            return True
        self.warn(f"Object '{obj.name}' is scaled to 0 or has a transform that is no number; it is left out.")
        return False

    def _arrays(self, obj: bpy.types.Object) -> meshes.MeshArrays:
        key = obj.data.as_pointer()
        if key not in self.arrays:
            self.arrays[key] = meshes.read(obj)
        return self.arrays[key]

    def _core_mesh(self, obj: bpy.types.Object, arrays: meshes.MeshArrays,
                   slots: frozenset[int]) -> core.Mesh:
        key = (obj.data.as_pointer(), slots)
        if key not in self.core_meshes:
            self.core_meshes[key] = meshes.to_core(obj.data.name, arrays, slots)
            for sentence in self.core_meshes[key].warnings:
                self.warn(sentence)
        return self.core_meshes[key]

    def _materials(self, obj: bpy.types.Object, used_slots: tuple[int, ...]) -> dict[int, int | None]:
        """For each used slot the core's material index, None where it isn't glass. Slots past the
        object's last take that one, as in Cycles."""
        slots = obj.material_slots
        found = {}
        for slot in used_slots:
            material = slots[min(slot, len(slots) - 1)].material if len(slots) else None
            found[slot] = self._material(obj, self.material_override or material)
        return found

    def _material(self, obj: bpy.types.Object, material: bpy.types.Material | None) -> int | None:
        if material is None:
            self.warn(f"Object '{obj.name}' has no material; it is rendered as glass of roughness 0.25.")
        key = material.name_full if material else ""
        if key not in self.material_indices:
            glass = materials.from_blender(material, self.warn) if material else materials.default_glass("")
            self.material_indices[key] = None if glass is None else self.scene.add_material(glass)
        if self.material_indices[key] is None:
            self.warn(f"Object '{obj.name}': material '{material.name}' has no glass in it; opaque materials "
                      "aren't supported yet, so its faces are left out.")
        return self.material_indices[key]

    def _warn_of_features(self, obj: bpy.types.Object) -> None:
        if obj.is_holdout:
            self.warn(f"Object '{obj.name}' is a holdout, which isn't supported yet; that is ignored.")
        particles = (system.settings for system in obj.particle_systems)
        if any(settings.type == 'HAIR' and settings.render_type == 'PATH' for settings in particles):
            self.warn(f"Object '{obj.name}' has hair, which isn't supported yet; it is left out.")
