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
        self.scene = os.path.join(folder, name + ".json")
        self.report = os.path.join(folder, "report.json")
        self.pixels = os.path.join(folder, "pixels.f32")
        points = [{"value": v, "colour": [r, g, b], "opacity": a} for v, r, g, b, a in transfer]
        scene = {
            "version": 1,
            "name": name,
            "camera": {"kind": "perspective", "eye_mm": list(subjects.EYE), "target_mm": list(subjects.CENTRE),
                       "up": [0, 0, 1], "vertical_fov_deg": subjects.FOV_DEG},
            "targets": {"volume.colour": {"format": "rgba32f"}},
            "passes": [{"name": "cast", "effect": "volume.ray_cast",
                        "parameters": {"volume": {"file": file}, "function": "composite",
                                       "crop": {"first": [0.5] * 3, "size": [subjects.SIDE - 1] * 3},
                                       "transfer_function": {"points": points}, "sampling": {}}}],
            "outputs": ["volume.colour"],
        }
        with open(self.scene, "w") as stream:
            json.dump(scene, stream)

    def _run(self, sampling, repeats, interpolate=False):
        sets = ["/passes/0/parameters/sampling=" + json.dumps(sampling),
                "/passes/0/parameters/transfer_function/interpolate=" + json.dumps(interpolate)]
        command = [self.program, "bench", "--scene", self.scene, "--repeats", str(repeats),
                   "--resolution", "%dx%d" % (subjects.SIZE, subjects.SIZE),
                   "--report", self.report, "--pixels", self.pixels]
        for one in sets:
            command += ["--set", one]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(self.report) as stream:
            return json.load(stream)["rows"][0]

    def _picture(self):
        return np.fromfile(self.pixels, np.float32).reshape(subjects.SIZE, subjects.SIZE, 4)

    def frame(self, sampling, repeats=3):
        """(processor s, wall s), medians over warm frames, and the picture."""
        row = self._run(sampling, repeats)
        return row["cpu_ms"]["median"] / 1e3, row["time_ms"]["median"] / 1e3, self._picture()

    def exact(self):
        """The most exact picture: a sixteenth of a voxel, weights of full precision, an interpolated table, no early end."""
        self._run({"scheme": "gauss", "step": 1 / 16, "filter": "linear_fp32", "termination": 0}, 1, True)
        return self._picture()
