"""What both programs show: volumes of 256^3 voxels, transfer functions and one camera."""
import numpy as np

SIDE = 256
SIZE = 512  # pixels
FOV_DEG = 30.0
CENTRE = np.full(3, (SIDE - 1) / 2)
EYE = CENTRE + 2.2 * (SIDE - 1) * np.array([0.45, -1.0, 0.35]) / np.linalg.norm([0.45, -1.0, 0.35])

# value, red, green, blue, opacity per mm
TRANSFER = {
    "head": [(-1000, 0, 0, 0, 0), (-150, 0.7, 0.4, 0.3, 0), (-30, 0.8, 0.45, 0.35, 0.015), (100, 0.8, 0.5, 0.4, 0.015),
             (300, 0.9, 0.8, 0.6, 0.05), (800, 1, 0.95, 0.85, 0.25), (2200, 1, 1, 1, 0.6)],
    "sphere": [(0, 0.3, 0.5, 0.9, 0), (1000, 0.95, 0.85, 0.6, 0.02)],
}


def _blend(field, inside_mm, value):
    """Puts `value` where `inside_mm` > 0, with an edge one voxel wide."""
    share = np.clip(inside_mm + 0.5, 0, 1)
    field += share * (value - field)


def _coordinates():
    a = np.arange(SIDE, dtype=np.float32) - np.float32((SIDE - 1) / 2)
    return a[None, None, :], a[None, :, None], a[:, None, None]


def sphere():
    """1000 inside a radius of 100 voxels, 0 outside."""
    x, y, z = _coordinates()
    field = np.zeros((SIDE,) * 3, np.float32)
    _blend(field, 100 - np.sqrt(x * x + y * y + z * z), 1000)
    return np.rint(field).astype(np.int16)


def head():
    """Skin, skull, brain, ventricles, sinuses, eyes and teeth as ellipsoids with CT numbers and noise."""
    x, y, z = _coordinates()
    field = np.full((SIDE,) * 3, -1000, np.float32)

    def ellipsoid(centre, radii, value):
        middle = (SIDE - 1) / 2
        box = tuple(slice(max(int(middle + m - r) - 2, 0), int(middle + m + r) + 3)
                    for m, r in zip(centre[::-1], radii[::-1]))
        near = (x[:, :, box[2]], y[:, box[1], :], z[box[0], :, :])
        u = [(c - np.float32(m)) / np.float32(r) for c, m, r in zip(near, centre, radii)]
        level = np.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
        slope = np.sqrt(sum((c / np.float32(r)) ** 2 for c, r in zip(u, radii)))
        _blend(field[box], (1 - level) * level / np.maximum(slope, 1e-6), value)

    ellipsoid((0, 0, 0), (88, 108, 114), 45)
    ellipsoid((0, -106, -18), (13, 20, 18), 45)
    ellipsoid((0, 3, 4), (80, 98, 104), 1000)
    ellipsoid((0, 3, 5), (74, 92, 98), 35)
    for side in (-1, 1):
        ellipsoid((side * 14, 0, 14), (8, 34, 14), 8)
        ellipsoid((side * 33, -84, 2), (18, 18, 17), 15)
        ellipsoid((side * 22, -76, -42), (14, 15, 17), -950)
        ellipsoid((side * 76, 6, -20), (6, 12, 10), -600)
    ellipsoid((0, 14, -100), (15, 17, 26), 700)
    for angle in np.linspace(-1.1, 1.1, 10):
        ellipsoid((38 * np.sin(angle), -36 - 38 * np.cos(angle), -70), (4.5, 4.5, 9), 2200)
    field += np.random.default_rng(5).normal(0, 8, field.shape).astype(np.float32)
    return np.clip(np.rint(field), -1000, 2400).astype(np.int16)


VOLUMES = {"head": head, "sphere": sphere}


def write_metaimage(path, volume):
    """Voxel (i, j, k), i fastest, has its centre at (i, j, k) mm."""
    header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
              "CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\n"
              "ElementSpacing = 1 1 1\nDimSize = %d %d %d\nElementType = MET_SHORT\nElementDataFile = LOCAL\n")
    with open(path, "wb") as file:
        file.write((header % volume.shape[::-1]).encode())
        file.write(volume.astype("<i2").tobytes())


def rays(pixels):
    """Eye and unit directions through the centres of pixels (column, row from the top)."""
    forward = (CENTRE - EYE) / np.linalg.norm(CENTRE - EYE)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    reach = np.tan(np.radians(FOV_DEG) / 2)
    across = (2 * (pixels[:, 0] + 0.5) / SIZE - 1) * reach
    down = (2 * (pixels[:, 1] + 0.5) / SIZE - 1) * reach
    directions = forward + across[:, None] * right - down[:, None] * up
    return EYE, directions / np.linalg.norm(directions, axis=1, keepdims=True)
