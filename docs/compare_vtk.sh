#!/bin/sh
# Times viscera beside VTK on the same volumes, camera and transfer functions, with the error of each picture.
# docs/compare_vtk.sh [path of viscera] [further options of docs/vtk/compare.py]; writes docs/vtk.md and docs/vtk.svg.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
viscera=${1:-viscera}
[ $# -gt 0 ] && shift

missing=
has_module() { /usr/bin/python3 -c "import $1" 2>/dev/null; }
has_module numpy || missing="$missing python3-numpy"
has_module matplotlib || missing="$missing python3-matplotlib"
has_module vtkmodules.vtkRenderingVolumeOpenGL2 || missing="$missing python3-vtk9"
command -v xvfb-run >/dev/null || missing="$missing xvfb xauth"
if [ -n "$missing" ]; then
  echo "The comparison needs Debian packages that are not installed:$missing" >&2
  exit 1
fi
if ! command -v "$viscera" >/dev/null; then
  echo "viscera was not found as '$viscera'; give its path as the first argument" >&2
  exit 1
fi
exec xvfb-run -a -s "-screen 0 1024x768x24" /usr/bin/python3 "$here/vtk/compare.py" --viscera "$viscera" --out "$here" "$@"
