#!/usr/bin/env python3
"""Draws docs/pictures/damage_models.png: the damage of a glass plate under the local law and under front rules.

Needs numpy and a build of the tests: ninja -C build/release damage_fields && tools/damage_pictures.py
"""
import csv
import pathlib
import struct
import subprocess
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZE, MARGIN = 420, 12  # pixels of one plate, and around it


def png(path, pixels):
    height, width, _ = pixels.shape
    raw = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) +
                     chunk(b"IEND", b""))


def draw(points):
    """Seen from above: the share of failed points of every column, early failures red and late ones blue."""
    picture = np.full((SIZE, SIZE, 3), 238, np.uint8)
    low, high = points[:, [0, 2]].min(axis=0), points[:, [0, 2]].max(axis=0)
    last = max(points[:, 4].max(), 1e-12)
    columns = {}
    for x, _, z, damage, time in points:
        column = tuple(np.floor((np.array([x, z]) - low) / (high - low + 1e-9) * 60).astype(int))
        columns.setdefault(column, []).append((damage, time))
    for (i, j), values in columns.items():
        damage = np.mean([d for d, _ in values])
        times = [t for _, t in values if t >= 0]
        late = np.mean(times) / last if times else 0
        colour = np.array([200 * (1 - late), 30, 40 + 190 * late])
        shade = (1 - damage) * np.array([238, 238, 238]) + damage * colour
        picture[SIZE * j // 60:SIZE * (j + 1) // 60, SIZE * i // 60:SIZE * (i + 1) // 60] = shade.astype(np.uint8)
    return picture


def main():
    rows = subprocess.run([ROOT / "build/release/bin/damage_fields"], capture_output=True, text=True, check=True).stdout
    cases = {}
    for name, *numbers in csv.reader(rows.splitlines(), skipinitialspace=False):
        cases.setdefault(name, []).append([float(v) for v in numbers])
    height, width = SIZE + 2 * MARGIN, len(cases) * (SIZE + MARGIN) + MARGIN
    sheet = np.full((height, width, 3), 255, np.uint8)
    for n, points in enumerate(cases.values()):
        left = MARGIN + n * (SIZE + MARGIN)
        sheet[MARGIN:MARGIN + SIZE, left:left + SIZE] = draw(np.array(points))
    target = ROOT / "docs/pictures/damage_models.png"
    png(target, sheet)
    print(target)


if __name__ == "__main__":
    main()
