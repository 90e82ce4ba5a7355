# SPDX-License-Identifier: GPL-3.0-or-later
"""Verglas' own panels, and the built-in ones that stay visible with it."""

import textwrap

import bpy

from . import compat, devices, faults

ENGINE = 'VERGLAS'

EXCLUDED_PANELS = {
    'DATA_PT_area',
    'DATA_PT_falloff_curve',
    'DATA_PT_light',
    'DATA_PT_camera_stereoscopy',
    'RENDER_PT_stereoscopy',
}
"""Built-in panels for what Verglas doesn't support, or has another one for."""

DEVICES = {'OPENGL': "OpenGL", 'CPU': "the CPU"}
"""As the user reads them."""

SUBJECT_ICONS = {
    'Camera': 'CAMERA_DATA',
    'Image': 'IMAGE_DATA',
    'Light': 'LIGHT_DATA',
    'Material': 'MATERIAL',
    'Scene': 'SCENE_DATA',
    'World': 'WORLD',
}
"""Beside what warnings are about, by the first word of faults.subject."""


class VerglasPanel:
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self.draw_settings(context, self.layout)


class VERGLAS_RENDER_PT_messages(VerglasPanel, bpy.types.Panel):
    bl_label = "Warnings"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and any(faults.listed())

    def draw_settings(self, context, layout):
        characters = max(20, int(context.region.width / context.preferences.system.ui_scale / 7.0))
        broken, groups = faults.listed()
        for sentence in broken:
            _draw_sentence(layout, sentence, characters, 'CANCEL')
        for subject, sentences in groups.items():
            box = layout.box().column()
            if subject:
                box.label(text=subject, icon=_icon_of(subject))
            for sentence in sentences:
                _draw_sentence(box, sentence, characters, 'ERROR')


def _icon_of(subject: str) -> str:
    return SUBJECT_ICONS.get(subject.split(" ", 1)[0], 'OBJECT_DATA')


def _draw_sentence(layout: bpy.types.UILayout, sentence: str, characters: int, icon: str) -> None:
    column = layout.column(align=True)
    for i, line in enumerate(textwrap.wrap(sentence, characters)):
        column.label(text=line, icon='BLANK1' if i else icon)


class VERGLAS_RENDER_PT_sampling(VerglasPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_settings(self, context, layout):
        settings = context.scene.verglas
        layout.prop(settings, "method")
        layout.prop(settings, "device")
        if settings.device == 'AUTO' and devices.automatic:
            row = layout.row()
            row.alignment = 'RIGHT'
            row.label(text=f"Auto takes {DEVICES[devices.automatic]}")
        if settings.method == 'REFERENCE':
            layout.prop(settings, "reference_samples")
            layout.prop(settings, "reference_paths")
            if settings.reference_paths == 'TWO_INTERFACE':
                layout.prop(settings, "reference_tir")
            layout.prop(settings, "reference_seed")
        else:
            if 'OPENGL' in devices.in_use(context.scene) or settings.traced_final:
                layout.column(heading="Final Frames").prop(settings, "traced_final", text="Traced")
            layout.prop(settings, "samples", text="Render Samples")
        layout.prop(settings, "viewport_samples")
        layout.prop(settings, "filter_width")


class VERGLAS_RENDER_PT_glass(VerglasPanel, bpy.types.Panel):
    bl_label = "Glass"

    def draw_settings(self, context, layout):
        settings = context.scene.verglas
        in_use = devices.in_use(context.scene)
        if 'OPENGL' in in_use:
            layout.prop(settings, "transport")
            layout.prop(settings, "intersection")
            layout.prop(settings, "tir")
            layout.prop(settings, "back_roughness")
            if settings.back_roughness == 'COVERAGE':
                layout.prop(settings, "roughness_classes")
        if 'CPU' in in_use:
            layout.prop(settings, "max_interfaces")
        layout.prop(settings, "lobes")
        layout.prop(settings, "reflection")


class VERGLAS_RENDER_PT_film(VerglasPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {'DEFAULT_CLOSED'}

    def draw_settings(self, context, layout):
        layout.prop(context.scene.render, "film_transparent", text="Transparent")


class VERGLAS_RENDER_PT_performance(VerglasPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {'DEFAULT_CLOSED'}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and 'CPU' in devices.in_use(context.scene)

    def draw_settings(self, context, layout):
        render = context.scene.render
        layout.prop(render, "threads_mode")
        column = layout.column()
        column.enabled = render.threads_mode == 'FIXED'
        column.prop(render, "threads")


class VERGLAS_VIEWLAYER_PT_passes(VerglasPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw_settings(self, context, layout):
        layer = context.view_layer
        column = layout.column(heading="Include")
        column.prop(layer, "use_pass_z", text="Depth")
        column.prop(layer, "use_pass_normal", text="Normal")


class VERGLAS_MATERIAL_PT_glass(VerglasPanel, bpy.types.Panel):
    bl_label = "Verglas"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material is not None

    def draw_settings(self, context, layout):
        settings = context.material.verglas
        layout.prop(settings, "kind")
        if settings.kind != 'COATED':
            layout.prop(settings, "ndf")
        if settings.kind == 'PANE':
            layout.prop(settings, "inner_roughness")
            layout.template_ID(settings, "inner_image", open="image.open")
            layout.prop(settings, "inner_reflections")
        elif settings.kind == 'COATED':
            layout.prop(settings, "outer_roughness")
            layout.template_ID(settings, "outer_image", open="image.open")
            for name in ("coating_ior", "metal", "bounces", "thickness",
                         "absorption_color", "absorption_density"):
                layout.prop(settings, name)
        else:
            layout.prop(settings, "absorption_color")
            layout.prop(settings, "absorption_density")
            layout.prop(settings, "priority")
        layout.prop(settings, "bake_resolution")


class VERGLAS_VIEW3D_PT_shading_lighting(bpy.types.Panel):
    """Blender's own panel for Rendered shading shows itself to EEVEE alone."""
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'HEADER'
    bl_label = "Lighting"
    bl_parent_id = 'VIEW3D_PT_shading'

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE and context.space_data.shading.type == 'RENDERED'

    def draw(self, context):
        shading = context.space_data.shading
        column = self.layout.column()
        column.prop(shading, "use_scene_lights_render")
        column.prop(shading, "use_scene_world_render")
        if not shading.use_scene_world_render:
            row = column.row()
            row.scale_y = 0.6
            row.template_icon_view(shading, "studio_light", scale_popup=3.0)
            column.prop(shading, "studiolight_rotate_z", text="Rotation")
            column.prop(shading, "studiolight_intensity")
            column.prop(shading, "studiolight_background_alpha")
            column.prop(shading, "studiolight_background_blur")


_classes = (
    VERGLAS_VIEW3D_PT_shading_lighting,
    VERGLAS_RENDER_PT_messages,
    VERGLAS_RENDER_PT_sampling,
    VERGLAS_RENDER_PT_glass,
    VERGLAS_RENDER_PT_film,
    VERGLAS_RENDER_PT_performance,
    VERGLAS_VIEWLAYER_PT_passes,
    VERGLAS_MATERIAL_PT_glass,
)


def built_in_panels():
    """Blender's panels that make sense with Verglas."""
    for panel in bpy.types.Panel.__subclasses__():
        offered = 'BLENDER_RENDER' in getattr(panel, 'COMPAT_ENGINES', ())
        if offered and panel.__name__ not in EXCLUDED_PANELS:
            yield panel
    for name in compat.ADOPTED_PANELS:
        panel = getattr(bpy.types, name, None)
        if panel is not None:
            yield panel


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    for panel in built_in_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in built_in_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
