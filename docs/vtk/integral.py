"""Emission and absorption along single rays in double precision, apart from both programs."""
import numpy as np

import subjects


def _trilinear(volume, places):
    low = np.clip(np.floor(places).astype(int), 0, subjects.SIDE - 2)
    part = places - low
    value = np.zeros(len(places))
    for corner in range(8):
        offset = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        weight = np.prod(np.where(offset == 1, part, 1 - part), axis=1)
        x, y, z = (low + offset).T
        value += weight * volume[z, y, x]
    return value


def composite(volume, transfer, pixels, step=1 / 64):
    """RGBA, premultiplied, of pixels (column, row): midpoints of `step` mm between the outermost voxel centres."""
    eye, directions = subjects.rays(pixels)
    table = np.array(transfer, float)
    result = np.zeros((len(pixels), 4))
    for index, direction in enumerate(directions):
        a, b = -eye / direction, (subjects.SIDE - 1 - eye) / direction
        start, end = np.minimum(a, b).max(), np.maximum(a, b).min()
        if end <= start:
            continue
        count = int(np.ceil((end - start) / step))
        length = (end - start) / count
        along = start + (np.arange(count) + 0.5) * length
        value = _trilinear(volume, eye + along[:, None] * direction)
        red, green, blue, opacity = (np.interp(value, table[:, 0], table[:, c]) for c in range(1, 5))
        depth = -np.log1p(-opacity) * length
        behind = np.cumsum(depth)
        weight = np.exp(-(behind - depth)) * -np.expm1(-depth)
        result[index] = [weight @ red, weight @ green, weight @ blue, -np.expm1(-behind[-1])]
    return result
