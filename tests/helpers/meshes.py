"""Mesh files of one triangle, and the small arm that shows one."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from helpers.urdf_texts import replaced

TRIANGLE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]


def arm(filename: str, part: str = "visual") -> str:
    """The arm with a mesh on its fore link."""
    shape = f'<{part}><geometry><mesh filename="{filename}"/></geometry></{part}>'
    return replaced('<link name="fore">', f'<link name="fore">{shape}')


def stl(path: Path, vertices: list[list[float]] = TRIANGLE) -> Path:
    """A binary STL file of one triangle."""
    path.parent.mkdir(parents=True, exist_ok=True)
    numbers = np.array([[0.0, 0.0, 1.0], *vertices], dtype="<f4")
    path.write_bytes(b" " * 80 + struct.pack("<I", 1) + numbers.tobytes() + b"\0\0")
    return path


def dae(path: Path, image: str) -> Path:
    """A Collada file of one triangle with one image."""
    path.write_text(f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_images><image id="i"><init_from>{image}</init_from></image></library_images>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="f" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#f" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
""")
    return path
