"""viscera through its command line: timed frames and float pictures."""
import json
import os
import subprocess

import numpy as np

import subjects


class VisceraSide:
    """Composition without shading. VTK's box ends at the outermost voxel centres, so half a voxel is cropped."""

    def __init__(self, program, folder, name, file, transfer):
        self.program = program
        self.scenes = {}
        self.report = os.path.join(folder, "report.json")
        self.pixels = os.path.join(folder, "pixels.f32")
        points = [{"value": v, "colour": [r, g, b], "opacity": a} for v, r, g, b, a in transfer]
        cast = {"volume": {"file": file}, "function": "composite",
                "crop": {"first": [0.5] * 3, "size": [subjects.SIDE - 1] * 3},
                "transfer_function": {"points": points}, "sampling": {}}
        coarse = {"name": "coarse", "effect": "volume.ray_cast", "parameters": cast | {"mixed": {"pass": "coarse"}}}
        fine = {"name": "fine", "effect": "volume.ray_cast", "parameters": cast | {"mixed": {"pass": "fine"}}}
        self._write(folder, name, [{"name": "cast", "effect": "volume.ray_cast", "parameters": cast}])
        self._write(folder, name + "_mixed", [coarse, fine])

    def _write(self, folder, name, passes):
        scene = {
            "version": 1,
            "name": name,
            "camera": {"kind": "perspective", "eye_mm": list(subjects.EYE), "target_mm": list(subjects.CENTRE),
                       "up": [0, 0, 1], "vertical_fov_deg": subjects.FOV_DEG},
            "targets": {"volume.colour": {"format": "rgba32f"}},
            "passes": passes,
            "outputs": ["volume.colour"],
        }
        if len(passes) > 1:
            scene["targets"]["volume.coarse"] = {"format": "rgba32f", "scale": 0.5}
        self.scenes[len(passes)] = os.path.join(folder, name + ".json")
        with open(self.scenes[len(passes)], "w") as stream:
            json.dump(scene, stream)

    def _run(self, sampling, repeats, interpolate=False, mixed=None):
        passes = 1 if mixed is None else 2
        sets = []
        for i in range(passes):
            sets += ["/passes/%d/parameters/sampling=%s" % (i, json.dumps(sampling)),
                     "/passes/%d/parameters/transfer_function/interpolate=%s" % (i, json.dumps(interpolate))]
        if mixed is not None:
            sets += ["/passes/1/parameters/mixed/tolerance=%g" % mixed["tolerance"],
                     "/targets/volume.coarse/scale=%g" % mixed["scale"]]
        command = [self.program, "bench", "--scene", self.scenes[passes], "--repeats", str(repeats),
                   "--resolution", "%dx%d" % (subjects.SIZE, subjects.SIZE),
                   "--report", self.report, "--pixels", self.pixels]
        for one in sets:
            command += ["--set", one]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(self.report) as stream:
            return json.load(stream)["rows"][0]

    def _picture(self):
        return np.fromfile(self.pixels, np.float32).reshape(subjects.SIZE, subjects.SIZE, 4)

    def frame(self, sampling, mixed=None, repeats=3):
        """(processor s, wall s), medians over warm frames, and the picture. mixed: its tolerance and scale."""
        row = self._run(sampling, repeats, mixed=mixed)
        return row["cpu_ms"]["median"] / 1e3, row["time_ms"]["median"] / 1e3, self._picture()

    def exact(self):
        """The most exact picture: a sixteenth of a voxel, weights of full precision, an interpolated table, no early end."""
        self._run({"scheme": "gauss", "step": 1 / 16, "filter": "linear_fp32", "termination": 0}, 1, True)
        return self._picture()
