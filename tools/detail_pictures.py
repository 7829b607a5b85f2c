#!/usr/bin/env python3
"""Draws docs/pictures/surface_detail.png: one crack without detail and with every preset, under grazing light.

Needs numpy and a build of the tests: ninja -C build/release detail_gallery && tools/detail_pictures.py
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from damage_pictures import ROOT, png  # noqa: E402

SIZE, MARGIN, TEXT = 460, 10, 3  # pixels of one look, around it, and of one dot of its name
NAMES = ["none", "glass", "ceramic", "metal", "clay", "plaster", "concrete", "slate", "rock"]
COLOURS = {"none": (196, 196, 196), "glass": (150, 190, 188), "ceramic": (222, 218, 208), "metal": (150, 152, 160),
           "clay": (196, 120, 84), "plaster": (226, 222, 214), "concrete": (168, 164, 156), "slate": (108, 116, 128),
           "rock": (158, 136, 112)}
FONT = {"a": "0e111f1111", "b": "1e111e111e", "c": "0f1010100f", "e": "1f101e101f", "g": "0f1013110f", "i": "0e0404040e",
        "k": "11121c1211", "l": "101010101f", "m": "111b151111", "n": "1119151311", "o": "0e1111110e", "p": "1e111e1010",
        "r": "1e111e1211", "s": "0f100e011e", "t": "1f04040404", "y": "110a040404"}


def load(path):
    vertices, faces = [], []
    for line in path.read_text().splitlines():
        kind, *rest = line.split()
        (vertices if kind == "v" else faces).append(rest)
    return np.array(vertices, float), np.array(faces, int) - 1


def camera(vertices):
    """Pixel coordinates and depth, seen obliquely from above."""
    forward = np.array([-0.1, -1.0, -0.6])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    centred = vertices - [0.5, 0.5, 0.5]
    scale = SIZE / 1.16
    return SIZE / 2 + scale * centred @ right, SIZE / 2 + 14 - scale * centred @ up, centred @ forward


def smooth_normals(vertices, faces):
    corners = vertices[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat *= np.where(flat[:, 1:2] < 0, -1, 1)
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, faces[:, corner], flat)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def lit(normals, colour, shine):
    """A low sun, some sky, and a highlight."""
    sun = np.array([0.85, 0.42, -0.35])
    sun /= np.linalg.norm(sun)
    view = np.array([0.1, 1.0, 0.6])
    view /= np.linalg.norm(view)
    half = (sun + view) / np.linalg.norm(sun + view)
    light = 0.16 + 0.10 * normals[:, 1:2] + 1.05 * np.maximum(normals @ sun, 0)[:, None]
    spark = shine * np.maximum(normals @ half, 0)[:, None] ** 40
    return np.clip(np.array(colour) * light + 255 * spark, 0, 255)


def draw(vertices, faces, colour, shine):
    """A z-buffer over the part in the unit block; colours are interpolated between vertices."""
    picture = np.full((SIZE, SIZE, 3), 255.0)
    depths = np.full((SIZE, SIZE), np.inf)
    inside = ((vertices > -1e-9) & (vertices < 1 + 1e-9))[:, [0, 2]].all(axis=1)
    faces = faces[inside[faces].all(axis=1)]
    px, py, depth = camera(vertices)
    shades = lit(smooth_normals(vertices, faces), colour, shine)
    for face in faces:
        x, y = px[face], py[face]
        area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
        if area == 0:
            continue
        columns = np.arange(max(int(np.ceil(x.min())), 0), min(int(x.max()), SIZE - 1) + 1)
        rows = np.arange(max(int(np.ceil(y.min())), 0), min(int(y.max()), SIZE - 1) + 1)[:, None]
        if columns.size == 0 or rows.size == 0:
            continue
        u = ((columns - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (rows - y[0])) / area
        v = ((x[1] - x[0]) * (rows - y[0]) - (columns - x[0]) * (y[1] - y[0])) / area
        w = 1 - u - v
        z = w * depth[face[0]] + u * depth[face[1]] + v * depth[face[2]]
        block = np.s_[rows[0, 0]:rows[-1, 0] + 1, columns[0]:columns[-1] + 1]
        nearer = (u >= -1e-9) & (v >= -1e-9) & (w >= -1e-9) & (z < depths[block])
        shade = w[..., None] * shades[face[0]] + u[..., None] * shades[face[1]] + v[..., None] * shades[face[2]]
        depths[block][nearer] = z[nearer]
        picture[block][nearer] = shade[nearer]
    return picture.astype(np.uint8)


def write_text(picture, text):
    for n, letter in enumerate(text):
        rows = [int(FONT[letter][i:i + 2], 16) for i in range(0, 10, 2)]
        for i, row in enumerate(rows):
            for j in range(5):
                if row >> (4 - j) & 1:
                    top, left = 6 + TEXT * i, 8 + TEXT * (6 * n + j)
                    picture[top:top + TEXT, left:left + TEXT] = 40


def main():
    pitch = SIZE + MARGIN
    sheet = np.full((3 * pitch + MARGIN, 3 * pitch + MARGIN, 3), 255, np.uint8)
    with tempfile.TemporaryDirectory() as folder:
        program = sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/bin/detail_gallery"
        subprocess.run([program, folder], check=True)
        for n, name in enumerate(NAMES):
            vertices, faces = load(pathlib.Path(folder) / f"{name}.obj")
            shine = {"glass": 0.9, "metal": 0.5, "ceramic": 0.25}.get(name, 0)
            look = draw(vertices, faces, COLOURS[name], shine)
            write_text(look, name)
            top, left = MARGIN + n // 3 * pitch, MARGIN + n % 3 * pitch
            sheet[top:top + SIZE, left:left + SIZE] = look
    target = ROOT / "docs/pictures/surface_detail.png"
    png(target, sheet)
    print(target)


if __name__ == "__main__":
    main()
