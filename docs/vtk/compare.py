#!/usr/bin/python3
"""Time and error of viscera and VTK side by side: see docs/compare_vtk.sh."""
import argparse
import os
import statistics
import tempfile

import matplotlib
import numpy as np

import integral
import subjects
from viscera_side import VisceraSide
from vtk_side import VtkSide, version

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "viscera"
from matplotlib import pyplot  # noqa: E402

STEPS = [4, 3, 2, 1.5, 1, 0.7, 0.5, 0.25]
SCHEMES = ["midpoint", "gauss"]
CHECKED_PIXELS = 400
TOLERANCE = 0.1


class Timing:
    """Medians over rounds, and the error of the picture."""

    def __init__(self, samples, picture, exact):
        self.work = statistics.median(s[0] for s in samples)
        self.wall = statistics.median(s[1] for s in samples)
        difference = picture.astype(float) - exact
        self.rms = float(np.sqrt(np.mean(difference ** 2)))
        self.most = float(np.abs(difference).max())


def checked(exact, volume, transfer):
    """Largest difference of the exact picture from the integral in double precision, and where pixels are lit."""
    lit = np.argwhere(exact[:, :, 3] > 0.01)
    chosen = lit[np.random.default_rng(2).choice(len(lit), CHECKED_PIXELS, replace=False)]
    wanted = integral.composite(volume, transfer, chosen[:, ::-1])
    return float(np.abs(exact[chosen[:, 0], chosen[:, 1]] - wanted).max())


def measure(name, folder, options):
    """{series: [Timing by step]}, the check of the exact picture."""
    volume, transfer = subjects.VOLUMES[name](), subjects.TRANSFER[name]
    file = os.path.join(folder, name + ".mha")
    subjects.write_metaimage(file, volume)
    viscera = VisceraSide(options.viscera, folder, name, file, transfer)
    vtk = VtkSide(file, transfer)
    exact = viscera.exact().astype(float)
    check = checked(exact, volume, transfer)
    print("%s: exact picture within %.1e of the double-precision integral" % (name, check), flush=True)
    series = {"VTK": []} | {"viscera, " + scheme: [] for scheme in SCHEMES}
    for step in STEPS:
        samples = {key: [] for key in series}
        pictures = {}
        vtk.frame(step)
        for _ in range(options.rounds):
            samples["VTK"].append(vtk.frame(step))
            for scheme in SCHEMES:
                key = "viscera, " + scheme
                work, wall, pictures[key] = viscera.frame(
                    {"scheme": scheme, "step": step, "tolerance": TOLERANCE})
                samples[key].append((work, wall))
        pictures["VTK"] = vtk.picture(step)
        for key, found in series.items():
            found.append(Timing(samples[key], pictures[key], exact))
            t = found[-1]
            print("%-18s step %-5g %7.0f ms cpu %7.0f ms wall  rms %.2e  max %.2e"
                  % (key, step, 1e3 * t.work, 1e3 * t.wall, t.rms, t.most), flush=True)
    vtk.window.Finalize()
    return series, check


def at_equal_error(vtk, ours):
    """Processor time of VTK over the least measured of ours that errs no more; None when nothing of ours does."""
    times = [t.work for t in ours if t.rms <= vtk.rms]
    return vtk.work / min(times) if times else None


def table(series):
    ours = [t for key, found in series.items() if key != "VTK" for t in found]
    lines = ["| step, voxels | VTK ms | rms | max | midpoint ms | rms | max | VTK / midpoint | gauss ms | rms | max | "
             "VTK / gauss | at equal rms |", "| ---: " * 13 + "|"]
    for i, step in enumerate(STEPS):
        vtk, middle, gauss = (series[key][i] for key in ("VTK", "viscera, midpoint", "viscera, gauss"))
        cells = ["%g" % step, "%.0f" % (1e3 * vtk.work), "%.1e" % vtk.rms, "%.1e" % vtk.most]
        for one in (middle, gauss):
            cells += ["%.0f" % (1e3 * one.work), "%.1e" % one.rms, "%.1e" % one.most, "%.1f" % (vtk.work / one.work)]
        equal = at_equal_error(vtk, ours)
        cells.append("none" if equal is None else "%.1f" % equal)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def wall_table(series):
    lines = ["| step, voxels | " + " | ".join(series) + " |", "| ---: " * (1 + len(series)) + "|"]
    for i, step in enumerate(STEPS):
        lines.append("| %g | " % step + " | ".join("%.0f" % (1e3 * found[i].wall) for found in series.values()) + " |")
    return "\n".join(lines)


def draw(results, file):
    figure, axes = pyplot.subplots(1, len(results), figsize=(5.5 * len(results), 4.5), squeeze=False)
    for axis, (name, (series, _)) in zip(axes[0], results.items()):
        for (key, found), mark in zip(series.items(), "so^"):
            axis.loglog([1e3 * t.work for t in found], [t.rms for t in found], mark + "-", label=key)
        axis.set_title(name)
        axis.set_xlabel("processor time of a frame [ms]")
        axis.set_ylabel("root mean square error")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend()
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def text(results, options):
    parts = ["# viscera and VTK side by side", "",
             "Written by `docs/compare_vtk.sh`. The same volumes (256^3 voxels of 16 bits, made by `docs/vtk/subjects.py`), transfer",
             "functions, camera and size (%d^2) for viscera and VTK %s's GPU mapper, both on Mesa's llvmpipe: composition without"
             % (subjects.SIZE, version()),
             "shading or jitter. viscera has its defaults but for `sampling.tolerance` %g. Frames take turns; times are medians of" % TOLERANCE,
             "%d rounds and count the processor time of all threads, because other programs share the machine. viscera's times are" % options.rounds,
             "medians of warm frames in a program of its own, without reading or writing files,",
             "drawn into float targets; VTK's are of its 8-bit window, and its errors of a float target. Wall-clock times depend on what else",
             "ran and are comparable within a row only.",
             "",
             "Errors are those of all pixels and channels against viscera's most exact picture (Gauss points every sixteenth of a voxel,",
             "full-precision weights, interpolated table, no early end). That picture is held against a separate integration in",
             "double precision (`docs/vtk/integral.py`, midpoints of 1/64 voxel) at %d pixels." % CHECKED_PIXELS,
             "'At equal rms': VTK's time over the least measured time of viscera with an error no larger than VTK's.", "",
             "![Error over time](vtk.svg)"]
    for name, (series, check) in results.items():
        parts += ["", "## %s" % name.capitalize(), "",
                  "Largest difference between the exact picture and the integral in double precision: %.1e." % check, "",
                  "Processor time:", "", table(series), "", "Wall-clock time [ms]:", "", wall_table(series)]
    return "\n".join(parts) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--viscera", required=True, help="the program")
    parser.add_argument("--out", required=True, help="folder for vtk.md and vtk.svg")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--volumes", nargs="+", default=list(subjects.VOLUMES), choices=list(subjects.VOLUMES))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = {name: measure(name, folder, options) for name in options.volumes}
    draw(results, os.path.join(options.out, "vtk.svg"))
    with open(os.path.join(options.out, "vtk.md"), "w") as stream:
        stream.write(text(results, options))


if __name__ == "__main__":
    main()
