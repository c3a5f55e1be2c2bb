"""VTK's GPU ray caster: frames by step, timed, and float pictures."""
import time

import numpy as np
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401, registers the mapper
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkMetaImageReader
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume,
                                         vtkVolumeProperty)
from vtkmodules.vtkRenderingOpenGL2 import (vtkCameraPass, vtkFramebufferPass, vtkRenderPassCollection,
                                            vtkSequencePass, vtkTextureObject, vtkVolumetricPass)
from vtkmodules.vtkRenderingVolume import vtkGPUVolumeRayCastMapper

import subjects

VTK_FLOAT = 10


def version():
    return vtkVersion.GetVTKVersion()


class VtkSide:
    """Composition without shading, sample distance fixed, no jitter."""

    def __init__(self, file, transfer):
        reader = vtkMetaImageReader()
        reader.SetFileName(file)
        colour, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
        for value, red, green, blue, alpha in transfer:
            colour.AddRGBPoint(value, red, green, blue)
            opacity.AddPoint(value, alpha)
        look = vtkVolumeProperty()
        look.SetColor(colour)
        look.SetScalarOpacity(opacity)
        look.SetScalarOpacityUnitDistance(1.0)
        look.SetInterpolationTypeToLinear()
        look.ShadeOff()
        self.mapper = vtkGPUVolumeRayCastMapper()
        self.mapper.SetInputConnection(reader.GetOutputPort())
        self.mapper.AutoAdjustSampleDistancesOff()
        self.mapper.LockSampleDistanceToInputSpacingOff()
        self.mapper.UseJitteringOff()
        self.mapper.SetImageSampleDistance(1.0)
        shown = vtkVolume()
        shown.SetMapper(self.mapper)
        shown.SetProperty(look)
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.SetBackgroundAlpha(0)
        self.renderer.AddVolume(shown)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*subjects.EYE)
        camera.SetFocalPoint(*subjects.CENTRE)
        camera.SetViewUp(0, 0, 1)
        camera.SetViewAngle(subjects.FOV_DEG)
        self.renderer.ResetCameraClippingRange()
        self.window = vtkRenderWindow()
        self.window.OffScreenRenderingOn()
        self.window.SetMultiSamples(0)
        self.window.SetAlphaBitPlanes(1)
        self.window.SetSize(subjects.SIZE, subjects.SIZE)
        self.window.AddRenderer(self.renderer)

    def frame(self, step):
        """(processor s of all threads, wall s) of one frame."""
        self.mapper.SetSampleDistance(step)
        work, wall = time.process_time(), time.perf_counter()
        self.window.Render()
        self.window.WaitForCompletion()
        return time.process_time() - work, time.perf_counter() - wall

    def picture(self, step):
        """RGBA, premultiplied, float32, top row first; the window itself has 8 bits."""
        self.mapper.SetSampleDistance(step)
        volumes = vtkVolumetricPass()
        passes = vtkRenderPassCollection()
        passes.AddItem(volumes)
        sequence = vtkSequencePass()
        sequence.SetPasses(passes)
        camera = vtkCameraPass()
        camera.SetDelegatePass(sequence)
        target = vtkFramebufferPass()
        target.SetDelegatePass(camera)
        target.SetColorFormat(vtkTextureObject.Float32)
        self.renderer.SetPass(target)
        self.window.Render()
        size = subjects.SIZE
        pixels = np.empty((size, size, 4), np.float32)
        target.GetColorTexture().Download().Download2D(VTK_FLOAT, pixels, (size, size), 4, (0, 0))
        target.ReleaseGraphicsResources(self.window)
        self.renderer.SetPass(None)
        return pixels[::-1].copy()
