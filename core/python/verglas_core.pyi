"""Verglas' render core: scene-linear pictures of rough glass, with no knowledge of Blender.

Arrays are numpy, C-contiguous; other dtypes and layouts are converted. Pictures have row 0 at the
BOTTOM (OpenGL and Blender order). World space is right-handed with Z up; matrices are row-major
numpy arrays that act on column vectors (as Blender's ``Matrix``).

Nothing here prints. What was mended in the input stands in ``warnings`` of the object concerned,
each a whole sentence that names the mesh or file. What cannot be mended raises ``Error``.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

class Error(RuntimeError):
    """A fault with one sentence for the user; it names the object, material, file or pass."""

def interface_lobe(
    ndf: str, roughness: float, eta: float, cos_theta_o: float, event: str, lobes: str = "TABLE"
) -> tuple[float, float, tuple[float, float, float]]:
    """The spherical Gaussian that the renderer takes for what one rough interface sends to the viewer: its energy,
    its concentration kappa and its unit axis, in the frame n = +Z, o = (sin theta_o, 0, cos theta_o).

    ndf: as Material.ndf. roughness: 0 … 1. eta: n_behind / n_before, clamped to 1/3 … 3. cos_theta_o: 0 … 1.
    event: 'REFRACT' (weighted with 1 - F), 'REFRACT_WITHOUT_FRESNEL' or 'REFLECT'. Beyond the critical angle a
    refraction keeps what the rough interface lets through. lobes: as Settings.lobes. Raises Error for values out of
    range."""

def warped_beam(
    kappa_o: float, kappa_m: float, cos_theta_o: float, eta: float | None = None
) -> tuple[float, tuple[float, float, float]]:
    """The spherical Gaussian that a beam of directions o becomes at facets of normals m, both of von Mises-Fisher
    distributions of these concentrations: its concentration and its unit axis, in the frame of interface_lobe, by
    moments, without Fresnel's factor and masking. eta: n_behind / n_before of a refraction; None reflects. cos_theta_o:
    between the mean directions, 0 … 1 and above the critical angle's. Raises Error for values out of range."""

def kappa_by_jacobians(
    kappa_o: float, kappa_m: float, cos_theta_o: float, eta: float | None = None
) -> float:
    """The concentration that the ENDF paper has for it (Guo et al. 2015, eqs. 18 and 21)."""

def vmf_facing_area(kappa: float, cos_theta_o: float) -> float:
    """The integral of <o,m> over normals m of a von Mises-Fisher distribution (Guo et al. 2015, eq. 7), in closed
    form, within 0.008. kappa: above 0. cos_theta_o: 0 … 1. Raises Error for values out of range."""

class Mesh:
    """Triangles with normals. Immutable; give the same Mesh again and it isn't uploaded again.

    positions: (V, 3) float32, object space. normals: (V, 3) float32, need not be of unit length.
    triangles: (T, 3) uint32, counter-clockwise seen from outside. slots: (T,) uint16, the
    triangle's material slot, all 0 when left out. uvs: (V, 2) float32, coordinates of textures of roughness;
    normal_uvs, height_uvs: (V, 2), those of normal maps and of heights. tangents: (V, 4), for normal maps in tangent
    space, which a mesh without them does without: unit, object space, along the u that the map was made for, and 1
    where its v goes along normal x tangent, -1 where against.
    Triangles with a vertex that isn't finite, or without area, are left out, with a warning each
    kind. Zero or non-finite normals are replaced by the triangle's own. Indices out of range raise Error.
    A mesh without triangles is valid and draws nothing.
    """
    def __init__(
        self,
        name: str,
        positions: ArrayLike,
        normals: ArrayLike,
        triangles: ArrayLike,
        slots: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        normal_uvs: ArrayLike | None = None,
        tangents: ArrayLike | None = None,
        height_uvs: ArrayLike | None = None,
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def has_tangents(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...

class Texture:
    """A picture of single values over UV in [0, 1]^2. Immutable."""

    def __init__(
        self, name: str, values: ArrayLike, extension: str = "REPEAT", interpolation: str = "LINEAR",
        is_atlas: bool = False
    ) -> None:
        """values: (H, W) float32, row 0 at v = 0. extension: 'REPEAT', 'EXTEND' or 'CLIP' (0 outside).
        interpolation: 'LINEAR' (bilinear) or 'CLOSEST'. is_atlas: whether texels that are neighbours need not
        be so on the surface; then no means of them are looked up."""
    def sample(self, uvs: ArrayLike) -> NDArray[np.float32]:
        """(N,) values at uvs (N, 2)."""
    @property
    def name(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...

class VectorTexture:
    """The same of vectors."""

    def __init__(
        self, name: str, values: ArrayLike, extension: str = "REPEAT", interpolation: str = "LINEAR",
        is_atlas: bool = False
    ) -> None:
        """values: (H, W, 3) float32; the rest as Texture's."""
    @property
    def name(self) -> str: ...

class NormalMap:
    """Normals in place of the mesh's, as Blender's Normal Map node has them."""

    texture: VectorTexture | None
    """Colours 0 … 1 for -1 … 1, by the mesh's normal_uvs. Default None: no normal map."""
    space: str
    """What red, green and blue stand for: 'TANGENT' (default): the mesh's tangent, bitangent and normal; 'OBJECT' or
    'WORLD': X, Y and Z."""
    strength: float
    """0: the mesh's own normals; 1 (default): the map's."""

class BumpMap:
    """Normals of a height over the surface, as Blender's Bump node has them; they come after the normal map."""

    height: Texture | None
    """By the mesh's height_uvs. Slopes are differences over a texel. Default None: no bumps."""
    strength: float
    """0: the normals as they were; 1 (default): those of the heights."""
    distance: float
    """That a height of 1 stands for, in world units; below 0 heights go inward. Default 1."""

class Layer:
    """The inner side of a thin layer: the far side of a pane, the base under a coating."""

    roughness: float
    """0 … 1, alpha = roughness^2. Default 0.25."""
    roughness_texture: Texture | None
    """Roughnesses in place of `roughness`, by the mesh's uvs; clamped to 0 … 1. Default None."""
    inner_reflections: bool
    """Of a pane: whether light that its sides reflect between them counts. Default True."""
    thickness: float
    """Of a coating, in world units along the normal: how far the material's absorption acts. Default 0.01."""
    bounces: int
    """Of a coating: how often light that leaves it has met the base, at most; 0 … 8, 0: its outer side's reflection
    alone. Default 2."""
    diffuse: bool
    """Of a coating: whether its base is diffuse; else it is a rough conductor. Default False."""
    base_color: Sequence[float]
    """Of a coating: the base's RGB reflectance at straight incidence, seen from within, or its albedo. Default
    0.8."""
    edge_tint: Sequence[float]
    """Of a coating on a conductor: factor on Schlick's reflectance at 82 degrees (F82), RGB. Default 1."""

class Material:
    """A rough dielectric (Walter et al. 2007). All attributes can be read and set."""

    name: str
    kind: str
    """'SOLID' (default): glass that fills its object. 'PANE': a thin sheet of glass, both of whose sides, one of
    `roughness` and one of `layer`, lie at the surface. 'COATED': a clear layer of `roughness` on an opaque base."""
    @property
    def layer(self) -> Layer:
        """Of panes and coatings; to be changed in place."""
    ndf: str
    """'BECKMANN' (default), 'GGX' or 'BLINN_PHONG'; the last with exponent 2 / roughness^4 - 2."""
    roughness: float
    """Blender's slider, 0 … 1, of coatings … 1.189 (kappa = 2 / alpha^2 = 1); alpha = roughness^2. Default 0.5."""
    roughness_texture: Texture | None
    """Roughnesses in place of `roughness`, by the mesh's uvs; clamped to 0 … 1. Default None."""
    @property
    def normal_map(self) -> NormalMap:
        """To be changed in place."""
    @property
    def bump_map(self) -> BumpMap:
        """To be changed in place."""
    ior: float
    """Index of refraction inside, relative to the outside, 1/3 … 3 (clamped). Default 1.5."""
    priority: int
    """What counts where solids overlap, for the path tracer; the real-time renderer doesn't know it yet. 0
    (default): each surface stands by itself, `ior` is relative to whatever is around it, and absorptions add up,
    as in Cycles. From 1 on: the solid of highest priority counts, of equal ones the one entered last, and `ior`
    is that of the medium itself."""
    color: Sequence[float]
    """Linear RGB factor of every refraction, entering and leaving (so its square for a solid)."""
    reflection_color: Sequence[float]
    """Linear RGB factor of the front reflection."""
    fresnel: bool
    """True (Glass): (1 - F) is refracted, F reflected. False (Refraction): all is refracted, nothing reflected."""
    absorption: Sequence[float]
    """sigma_a, RGB, per world unit: Beer-Lambert factor exp(-sigma_a distance) inside. Default 0. Of solids and
    coatings."""
    def __init__(self, name: str = "") -> None: ...

class EnvironmentMap:
    """An equirectangular picture of light from far away, of any resolution.

    Blender's orientation: direction +Z is the top row, the middle column looks along +X,
    u = 1/2 - atan2(y, x) / (2 pi). Texels that are NaN, negative or infinite are cleaned, with a warning.
    """
    def __init__(self, name: str, pixels: ArrayLike) -> None:
        """pixels: (H, W, 3 or 4) float32, scene-linear, row 0 at the bottom; alpha is ignored."""
    @staticmethod
    def load(path: str, srgb: bool = False) -> EnvironmentMap:
        """Any file that OpenImageIO reads; srgb: its values are sRGB-encoded. Raises Error with the path."""
    @property
    def name(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def pixels(self) -> NDArray[np.float32]:
        """(H, W, 3), as they were given, cleaned. A view, not to be written to."""
    @property
    def warnings(self) -> list[str]: ...

class Camera:
    view: NDArray[np.float32]
    """(4, 4) world -> camera; the camera looks along -Z (Blender's ``matrix_world.inverted()``, no scale)."""
    projection: NDArray[np.float32]
    """(4, 4) OpenGL projection, perspective or orthographic (``Object.calc_matrix_camera``)."""
    def __init__(self, view: ArrayLike | None = None, projection: ArrayLike | None = None) -> None: ...

class Scene:
    """What is rendered. Objects and materials are plain lists, in any order. Scenes are equal that share meshes,
    textures and maps and are alike in all else."""

    camera: Camera
    environment_map: EnvironmentMap | None
    environment_color: Sequence[float]
    """RGB radiance without a map; with one, the factor on it (strength). Default (0, 0, 0)."""
    environment_rotation: NDArray[np.float32]
    """(3, 3): map direction = rotation @ world direction. Default identity."""
    def __init__(self) -> None: ...
    def add_material(self, material: Material) -> int:
        """A copy of it as it is now; returns its index."""
    def add_object(self, name: str, mesh: Mesh, matrix: ArrayLike, materials: Sequence[int]) -> None:
        """matrix: (4, 4) object -> world, mirrored ones too. materials: material index of every slot;
        slots past the end take the last. Raises Error when empty, out of range or not finite."""
    def add_light(
        self,
        name: str,
        kind: str,
        place: Sequence[float],
        intensity: Sequence[float],
        radius: float = 0.0,
        axis: Sequence[float] = (0.0, 0.0, -1.0),
    ) -> None:
        """Shines beside the environment; isn't seen itself. kind: 'SPHERE', 'DISK' (as a sphere, but its light goes
        by the cosine to its axis, and none backward) or 'SUN'. place: of its centre, of a sun the unit direction
        toward it; world space. intensity: RGB, radiant, W/sr, of a disk along its axis; of a sun its irradiance.
        radius: in world units, 0 for a point; of a sun the half of its angle in radians. axis: unit, of a disk.
        Raises Error where one isn't finite, or the radius below 0."""
    @property
    def materials(self) -> list[Material]:
        """Copies of them, by index."""
    def __eq__(self, other: object) -> bool: ...
    @property
    def triangle_count(self) -> int:
        """Of all objects; a mesh counts as often as it is used."""

class Settings:
    width: int
    height: int
    """Whole frame in pixels, 1 … 16384 (the driver's limit may be lower). Default 512 x 512."""
    region: tuple[int, int, int, int] | None
    """(x, y, width, height) in pixels from the lower left: only this part is shaded and returned. Default whole."""
    pixel_size: int
    """Pixels along each side of the squares that are shaded as one; more than 1 for quick pictures of one sample.
    Default 1."""
    samples: int
    """Jittered samples a pixel, 1 … 65536. Default 16. The first looks through the pixel's centre."""
    filter_width: float
    """Width of the Blackman-Harris pixel filter in pixels, 0.01 … 10. Default 1.5 (Cycles' default)."""
    transport: str
    """How light crosses the object. 'BUNDLE' (default): four rays, each with its own exit; 'PAPER': one lobe against
    the exits' mean normal (de Rousiers et al. 2012); 'SINGLE': one ray along the lobe's axis. Two baselines with one
    ray by Snell's law: 'DEPTH_MIP', as wide as the distance inside says (Eisemann and Decoret 2006); 'SPECULAR',
    of smooth glass (Wyman 2005): no blur, and energies 1 - F."""
    intersection: str
    """'NEWTON' (default) or 'MARCH'."""
    lobes: str
    """Where the lobes of interfaces come from: 'TABLE' (default), tables of the BSDF of Walter et al. (2007), built
    once for each distribution of normals; 'ANALYTIC', closed forms (Guo et al. 2015), with nothing to build or to
    load, less exact."""
    tir: str
    """Total internal reflection: 'NONE', 'INCIDENT', 'CLAMP' (default) or 'BOUNCE', which follows the light that
    materials with Fresnel reflection reflect inside, totally or in part, from exit to exit, whatever `reflection`
    says; for transport 'BUNDLE' and intersection 'NEWTON', with others as 'CLAMP'."""
    back_roughness: str
    """Where a texture makes roughness vary, what back faces have of it. 'COVERAGE' (default): classes of
    roughness, each with the part that it covers of what a lobe reaches, for transports 'BUNDLE', 'PAPER' and
    'SINGLE'; 'SIMPLE': the texture's mean. Front faces have the texture itself."""
    roughness_classes: int
    """How many classes a texture has at most, 2 … 8. Default 4."""
    reflection: bool
    """Whether the front reflection of materials with fresnel is part of the picture. Default True."""
    transparent: bool
    """Film without background: alpha 0 where no object is. Default False."""
    paths: str
    """Of TracedRenderer: 'FULL' (default) or 'TWO_INTERFACE', as PathSettings.mode, without total reflection."""
    max_interfaces: int
    """Of TracedRenderer: how many a ray of the first sample crosses; light beyond comes from the environment.
    Default 8."""
    threads: int
    """Of TracedRenderer: how many work; 0 (default): one for each core. The picture doesn't depend on it."""
    def __init__(self) -> None: ...
    def __eq__(self, other: object) -> bool: ...

class Frame:
    """Premultiplied alpha, scene-linear."""

    @property
    def combined(self) -> NDArray[np.float32]:
        """(H, W, 4)"""
    @property
    def depth(self) -> NDArray[np.float32]:
        """(H, W) distance along the camera's axis at the pixel's centre; 1e10 where no object is."""
    @property
    def normal(self) -> NDArray[np.float32]:
        """(H, W, 3) world space, at the pixel's centre; 0 where no object is."""
    @property
    def seconds(self) -> float:
        """Wall time of the passes and readback, without uploads and table or environment work."""
    @property
    def pass_seconds(self) -> dict[str, float]:
        """GPU time by pass, summed over samples, of those that the frame has. In their order: 'back_faces',
        'inner_layers' (nearest backs, farthest fronts), 'coverage' (classes of roughness at all scales), 'pyramid'
        (normals and depths at all scales), 'front_faces', 'refraction', 'background', 'data' (depth and normals);
        and the wall time in which pixels come back from the GPU, 'readback'. Empty where the CPU made the frame."""
    @property
    def prepare_seconds(self) -> dict[str, float]:
        """Wall time before the passes: 'meshes' and 'textures' (upload), 'tables' (loaded or built, upload),
        'environment' (upload, prefiltering); 0 where nothing was new. Empty where the path tracer made the frame."""

class Renderer:
    """Owns the GL thread and what has been uploaded. Raises Error with one sentence where EGL or
    OpenGL 4.5 is missing. Environment variable VERGLAS_EGL_DEVICE picks a device by number."""
    def __init__(self) -> None: ...
    @property
    def device(self) -> str:
        """The driver's name for what renders, as 'llvmpipe (LLVM 15.0.6, 256 bits)'."""
    def render(
        self,
        scene: Scene,
        settings: Settings,
        progress: Callable[[int, int], bool] | None = None,
    ) -> Frame | None:
        """Waits for the picture, with the GIL released, and for those that other threads have asked for.
        progress(done, total) is called after each sample on the calling thread; when it returns False
        the render ends and None is returned."""

class TracedRenderer:
    """The CPU device: traces bundles of rays through the scene, and needs no OpenGL. Keeps what is costly to prepare:
    trees of meshes, lobe tables, the environment's levels. Raises Error where Embree can't be started."""
    def __init__(self) -> None: ...
    def render(
        self,
        scene: Scene,
        settings: Settings,
        progress: Callable[[int, int], bool] | None = None,
    ) -> Frame | None:
        """As Renderer.render; transport, intersection and tir of the settings are the OpenGL device's.
        One sample is a picture without noise, further ones converge to the path tracer's. progress(done, total)
        is called at least every few dozen milliseconds. Picture and noise depend on scene and settings alone."""

class ViewportRenderer:
    """Makes the pictures of any number of viewports by one device, on a thread of its own; nobody waits for it. Who
    asks for something new gets a quick picture first, shaded for squares of pixels, then one of all pixels, then
    pictures of ever more samples."""
    def __init__(self, device: Renderer | TracedRenderer) -> None: ...
    def stop(self) -> None:
        """No more pictures; waits for what is being made to end. To be called before the process ends."""

class ViewportView:
    """One viewport; it gets pictures as long as it lives."""
    def __init__(self, renderer: ViewportRenderer) -> None: ...
    def show(self, scene: Scene, settings: Settings, seconds: float) -> None:
        """Asks for this in place of what was asked for before; returns at once. The scene is copied. settings.samples:
        to grow to; pixel_size is chosen so that a quick picture takes no more than so many seconds."""
    def take(self) -> tuple[Frame, Settings] | None:
        """The newest picture, with what it was made by: its own samples and pixel_size; None where it has been
        taken before."""
    @property
    def has_news(self) -> bool:
        """Whether take() has a picture."""
    @property
    def is_done(self) -> bool:
        """Whether nothing more will come of what was asked for last."""
    @property
    def fault(self) -> str:
        """Why that can't be made, a sentence; "" where it can. The picture before stays."""

class RayScene:
    """The surfaces of a scene as it was given, for rays."""
    def __init__(self, scene: Scene) -> None: ...
    def intersect(self, origins: ArrayLike, directions: ArrayLike) -> dict[str, NDArray]:
        """What each ray meets first, from either side. origins, directions: (N, 3), world space; directions need
        not be of unit length. Returns 't': (N,) distances, infinite where there is nothing; 'geometric_normal':
        (N, 3), of the triangle, outward by its winding; 'normal': (N, 3), interpolated and bent by the material's
        normal map and bump map; 'material' and 'object': (N,) indices in the order in which they were added, -1 where
        there is nothing."""

class PathSettings:
    """Of the path tracer, the ground truth."""

    width: int
    height: int
    """Whole frame in pixels. Default 512 x 512."""
    region: tuple[int, int, int, int] | None
    """As Settings.region."""
    filter_width: float
    """As Settings.filter_width."""
    mode: str
    """'FULL' (default): reflection, inner reflections, re-entry; 'TWO_INTERFACE': enter, leave, and straight
    into the environment."""
    tir: bool
    """TWO_INTERFACE: whether totally reflected light goes on inside until it leaves; else (default) it is lost."""
    layers: str
    """Of coated surfaces: 'RECURSIVE' (default), from interface to interface, the truth; 'ENDF', in closed form,
    one draw for each bounce, by extended normal distribution functions (Guo et al. 2015); 'WEIDLICH_WILKIE', light
    that stays collimated in the layer and meets the base once (2007). A diffuse base has the last one's with both."""
    bounce: int | None
    """Of light that coatings send on, only what has met their base so often, 0 for that which their outer side
    reflects; None (default): all. Recursive sampling takes every path there, which costs it time with each bounce."""
    transparent: bool
    """As Settings.transparent."""
    max_interfaces: int
    """Paths through more that bend light end. Default 64."""
    seed: int
    """Other seeds give other noise. Default 0."""
    def __init__(self) -> None: ...

class PathTracer:
    """A picture that gains precision with each sample: Walter et al.'s microfacets sampled by visible normals
    (Blinn-Phong by its distribution), the environment by its radiance, both combined; roughness from textures.
    Panes and coatings are followed from side to side; the sides and conductors of coatings have normals of vMF
    distribution, kappa = 2 / alpha^2, and roughnesses up to 1.189 (kappa = 1). The scene's lights are blocked by
    all that bends light, and are seen by scattered rays alone. With 'TWO_INTERFACE', thin layers are as with
    'FULL', but for what blocks their light.
    It holds the scene as it was given. The same scene, settings and number of samples give the same picture, on
    any number of cores. Samples are points of a Sobol sequence: powers of two converge best."""

    def __init__(self, scene: Scene, settings: PathSettings) -> None: ...
    def render(self, samples: int, progress: Callable[[int, int], bool] | None = None) -> bool:
        """Adds samples to every pixel on all cores, with the GIL released. progress(done, samples) is called
        several times a second on the calling thread; when it returns False the render ends, and so does this,
        with False. Goes on from there when called again."""
    @property
    def samples(self) -> int:
        """Whole samples of all pixels so far."""
    def frame(self) -> Frame:
        """The mean so far; its `seconds` is the time spent in render(). Raises Error before the first sample."""
