#!/usr/bin/env bash
# Sets up, builds, and passes the tests. Argument: a preset, `ci` (default) or `asan`; the rest goes to ctest.
# VISCERA_DATA=FOLDER names real volumes, vessels and organs to test with.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-ci}
cmake/setup.sh
cmake --preset "$preset" -DVISCERA_DATA_DIR="${VISCERA_DATA:-}" >/dev/null
cmake --build --preset "$preset"
exec ctest --preset "$preset" "${@:2}"
