"""Boxes with a texture of four colours, as OBJ, DAE and GLB files."""

import io

import numpy as np
import trimesh
from PIL import Image

PAINT = np.array([[[200, 30, 30], [30, 160, 60]], [[30, 60, 200], [220, 200, 40]]], dtype=np.uint8)
"""Colours of the texture: red, green in the upper row; blue, yellow in the lower."""


def png(side=16):
    """Return the texture as a PNG file."""
    stream = io.BytesIO()
    Image.fromarray(np.repeat(np.repeat(PAINT, side, 0), side, 1)).save(stream, "PNG")
    return stream.getvalue()


PNG = png()
SIDES = [(0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1)]


def box_arrays():
    """Return vertices ``[24, 3]``, texture coordinates ``[24, 2]`` and triangles ``[12, 3]`` of a cube of side 1."""
    points, coordinates, faces = [], [], []
    for axis, sign in SIDES:
        first, second = ((axis + 1) % 3, (axis + 2) % 3) if sign > 0 else ((axis + 2) % 3, (axis + 1) % 3)
        start = len(points)
        for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
            point = np.zeros(3)
            point[axis], point[first], point[second] = 0.5 * sign, u - 0.5, v - 0.5
            points.append(point)
            coordinates.append((u, v))
        faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return np.array(points), np.array(coordinates, dtype=float), np.array(faces)


POINTS, UV, FACES = box_arrays()
BOX_MTL = "newmtl paint\nKd 0.8 0.8 0.8\nmap_Kd paint.png\n"
BOX_OBJ = "\n".join(
    [
        "mtllib box.mtl",
        *(f"v {x:g} {y:g} {z:g}" for x, y, z in POINTS),
        *(f"vt {u:g} {v:g}" for u, v in UV),
        "usemtl paint",
    ]
    + [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in FACES + 1]
    + [""]
)


def numbers(rows):
    return " ".join(f"{value:g}" for value in np.ravel(rows))


BOX_DAE = f"""<?xml version='1.0'?>
<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>
<asset><unit name='meter' meter='1'/><up_axis>Z_UP</up_axis></asset>
<library_images><image id='paint' name='paint'><init_from>paint.png</init_from></image></library_images>
<library_effects><effect id='look'><profile_COMMON>
<newparam sid='surface'><surface type='2D'><init_from>paint</init_from></surface></newparam>
<newparam sid='sampler'><sampler2D><source>surface</source></sampler2D></newparam>
<technique sid='common'><lambert><diffuse><texture texture='sampler' texcoord='UV'/></diffuse></lambert></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id='skin' name='skin'><instance_effect url='#look'/></material></library_materials>
<library_geometries><geometry id='box' name='box'><mesh>
<source id='points'><float_array id='pa' count='72'>{numbers(POINTS)}</float_array><technique_common>
<accessor source='#pa' count='24' stride='3'><param name='X' type='float'/><param name='Y' type='float'/>
<param name='Z' type='float'/></accessor></technique_common></source>
<source id='uv'><float_array id='ua' count='48'>{numbers(UV)}</float_array><technique_common>
<accessor source='#ua' count='24' stride='2'><param name='S' type='float'/><param name='T' type='float'/></accessor>
</technique_common></source>
<vertices id='vertices'><input semantic='POSITION' source='#points'/></vertices>
<triangles count='12' material='skin'><input semantic='VERTEX' source='#vertices' offset='0'/>
<input semantic='TEXCOORD' source='#uv' offset='0' set='0'/><p>{numbers(FACES)}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id='scene'><node id='body'>
<instance_geometry url='#box'><bind_material><technique_common><instance_material symbol='skin' target='#skin'>
<bind_vertex_input semantic='UV' input_semantic='TEXCOORD' input_set='0'/></instance_material></technique_common>
</bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url='#scene'/></scene></COLLADA>
"""


def box_glb():
    """Return the box as a GLB file with its texture inside."""
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.open(io.BytesIO(PNG)))
    look = trimesh.visual.TextureVisuals(uv=UV, material=material)
    box = trimesh.Trimesh(POINTS, FACES, visual=look, process=False)
    return bytes(trimesh.Scene(box).export(file_type="glb"))
