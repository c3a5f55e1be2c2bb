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
PLAIN = "viscera, every pixel"
MIXED = "viscera, mixed resolution"
TOLERANCE = 0.3


class Setting:
    """What viscera is told, the same for every volume."""

    def __init__(self, step, mixed_tolerance=None):
        self.sampling = {"scheme": "midpoint", "step": step, "tolerance": TOLERANCE}
        self.mixed = None
        self.name = "step %g" % step
        if mixed_tolerance is not None:
            self.sampling["termination"] = 0.01
            self.mixed = {"tolerance": mixed_tolerance, "scale": 0.34}
            self.name += ", mixed %g" % mixed_tolerance


SETTINGS = {
    PLAIN: [Setting(step) for step in STEPS],
    MIXED: [Setting(2, 0.2), Setting(2.5, 0.05), Setting(4, 0.02), Setting(2.5, 0.02), Setting(2, 0.03),
            Setting(1.5, 0.02), Setting(1, 0.01), Setting(1, 0.005)],
}
CHECKED_PIXELS = 400


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
    series = {"VTK": []} | {key: [] for key in SETTINGS}
    for i, step in enumerate(STEPS):
        samples = {key: [] for key in series}
        pictures = {}
        vtk.frame(step)
        for _ in range(options.rounds):
            samples["VTK"].append(vtk.frame(step))
            for key, settings in SETTINGS.items():
                work, wall, pictures[key] = viscera.frame(settings[i].sampling, settings[i].mixed)
                samples[key].append((work, wall))
        pictures["VTK"] = vtk.picture(step)
        for key, found in series.items():
            found.append(Timing(samples[key], pictures[key], exact))
            t = found[-1]
            label = "step %g" % step if key == "VTK" else SETTINGS[key][i].name
            print("%-26s %-18s %7.0f ms cpu %7.0f ms wall  rms %.2e  max %.2e"
                  % (key, label, 1e3 * t.work, 1e3 * t.wall, t.rms, t.most), flush=True)
    vtk.window.Finalize()
    return series, check


def fastest(vtk, series):
    """(name, timing) of viscera's fastest setting that errs no more than VTK; None when nothing of ours does."""
    ours = [(setting.name, timing) for key, settings in SETTINGS.items()
            for setting, timing in zip(settings, series[key]) if timing.rms <= vtk.rms]
    return min(ours, key=lambda one: one[1].work) if ours else None


def row(cells):
    return "| " + " | ".join(cells) + " |"


def cells_of(timing):
    return ["%.0f" % (1e3 * timing.work), "%.2e" % timing.rms, "%.1e" % timing.most]


def table(series):
    lines = [row(["VTK's step", "ms", "rms", "max", "viscera", "ms", "rms", "max", "times as fast"]),
             "| ---: | ---: | ---: | ---: | --- " + "| ---: " * 4 + "|"]
    for step, vtk in zip(STEPS, series["VTK"]):
        found = fastest(vtk, series)
        ours = ["none", "", "", "", ""]
        if found is not None:
            ours = [found[0]] + cells_of(found[1]) + ["%.1f" % (vtk.work / found[1].work)]
        lines.append(row(["%g" % step] + cells_of(vtk) + ours))
    return "\n".join(lines)


def own_table(series):
    lines = [row(["viscera", "ms", "rms", "max", "wall ms", "VTK at this step", "as fast"]),
             "| --- " + "| ---: " * 6 + "|"]
    for key, settings in SETTINGS.items():
        for setting, timing, vtk, step in zip(settings, series[key], series["VTK"], STEPS):
            beside = ["", ""]
            if key == PLAIN:
                beside = ["%.0f ms, %.2e" % (1e3 * vtk.work, vtk.rms), "%.1f" % (vtk.work / timing.work)]
            lines.append(row([setting.name] + cells_of(timing) + ["%.0f" % (1e3 * timing.wall)] + beside))
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
             "shading or jitter. Frames take turns; times are medians of",
             "%d rounds and count the processor time of all threads, because other programs share the machine. viscera's times are" % options.rounds,
             "medians of warm frames in a program of its own, without reading or writing files,",
             "drawn into float targets; VTK's are of its 8-bit window, and its errors of a float target. Wall-clock times depend on what else",
             "ran.", "",
             "viscera's settings are the same for both volumes: midpoints, `sampling.tolerance` %g and else the defaults; `mixed` t is mixed" % TOLERANCE,
             "resolution ([volume.md](volume.md)) with that `mixed.tolerance`, a coarse target of `scale` 0.34 and `termination` 0.01. VTK",
             "casts every pixel's ray (`ImageSampleDistance` 1).", "",
             "Errors are those of all pixels and channels against viscera's most exact picture (Gauss points every sixteenth of a voxel,",
             "full-precision weights, interpolated table, no early end). That picture is held against a separate integration in",
             "double precision (`docs/vtk/integral.py`, midpoints of 1/64 voxel) at %d pixels." % CHECKED_PIXELS, "",
             "![Error over time](vtk.svg)"]
    for name, (series, check) in results.items():
        parts += ["", "## %s" % name.capitalize(), "",
                  "Largest difference between the exact picture and the integral in double precision: %.1e." % check, "",
                  "Each step of VTK beside viscera's fastest setting that errs no more (processor time):", "", table(series), "",
                  "viscera's settings, and VTK's step beside the same step:", "", own_table(series)]
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
