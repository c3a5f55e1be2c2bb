#!/usr/bin/env bash
# Sets up, builds, and renders the default scene headless into out/. Further arguments go to `viscera render`.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target viscera_app assets
exec build/release/samples/viscera render assets/scenes/angiography.json -o out --dump all "$@"
