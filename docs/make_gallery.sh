#!/usr/bin/env bash
# Makes docs/gallery.md and its pictures: docs/make_gallery.sh [PATH OF viscera]
set -euo pipefail
cd "$(dirname "$0")/.."
viscera=${1:-build/release/samples/viscera}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
page=docs/gallery.md
printf '# Gallery\n\nMade by `docs/make_gallery.sh`; under each picture the command that gives it.\n' >$page

# name, target, caption, arguments
picture() {
    local name=$1 target=$2 caption=$3
    shift 3
    "$viscera" render "$@" --resolution "${size:-640x640}" -o "$out" --dump "$target" --png "$target" >/dev/null 2>"$out/log" || { cat "$out/log" >&2; exit 1; }
    mv "$out/0000.$target.png" "docs/images/$name.png"
    {
        printf '\n## %s\n\n![%s](images/%s.png)\n\n```sh\nviscera render' "$caption" "$caption" "$name"
        printf ' %q' "$@" --resolution "${size:-640x640}" --dump "$target" --png "$target"
        printf '\n```\n'
    } >>$page
}

scene=assets/scenes/angiography.json
picture angiography final 'Left coronary artery, RAO 30 caudal 20' $scene
picture filling final 'Filling' $scene --time 0.75
picture washout final 'Wash-out: contrast has left the main stem, the muscle blushes' $scene --time 3.35
picture main contrast.main 'The vessels alone: `contrast.main`' $scene
picture distance contrast.distance_view 'Distance map at the injection' $scene --set '/passes/-={"name":"map","effect":"contrast.distance","parameters":{"$ref":"#/shared/coronary"}}' --set '/passes/-={"name":"look","effect":"contrast.distance_view"}'
picture reflux contrast.reflux 'Smoke that flows back into the aortic root: `contrast.reflux`' $scene
picture ap final 'Another C-arm position, AP' $scene --set /camera/primary_deg=0 --set /camera/secondary_deg=0 --set /passes/0/parameters/file=../images/thorax.exr
picture thesis final 'The published tone curve, which jumps at half density' $scene --time 1.0 --set /passes/9/parameters/tone=thesis
picture vessels final 'A bifurcation, from the scene for vessels of your own' assets/scenes/vessels.json
picture head volume.colour 'CT of a head' assets/scenes/head.json
picture mip volume.colour 'MR angiogram, maximum intensity' assets/scenes/mip.json
picture isosurface volume.colour 'Skin and skull as surfaces, cut open' assets/scenes/isosurface.json
picture labels volume.colour 'Segments, with a bleed' assets/scenes/labels.json
picture cryosections volume.colour 'A head in the colours of its frozen slices' assets/scenes/cryosections.json
picture xray volume.colour 'X-ray, exact line integrals' assets/scenes/xray.json
picture rotational_ultrasound volume.colour 'Intravascular ultrasound of a coronary artery: a cylindrical volume, cut open' assets/scenes/rotational_ultrasound.json
picture spherical_shell volume.colour 'Unborn child before a volume probe: a spherical volume' assets/scenes/spherical_shell.json
picture axial slice.axial 'Axial slice, brain window: the bleed' assets/scenes/slices.json
picture coronal slice.coronal 'Coronal slice' assets/scenes/slices.json
picture sagittal slice.sagittal 'Sagittal slice' assets/scenes/slices.json
picture overlay volume.colour 'Blood flow as hue over the brain' assets/scenes/labels.json --set '/passes/0/parameters/overlay={"file":"../volumes/overlay.nrrd","strength":0.8,"points":[{"value":8,"colour":[0,0.1,1],"opacity":0},{"value":20,"colour":[0,0.4,1],"opacity":1},{"value":50,"colour":[0,1,0.3],"opacity":1},{"value":80,"colour":[1,0.2,0],"opacity":1}]}'
picture organ final 'Liver, gallbladder and omentum through a laparoscope' assets/scenes/organ.json
picture organ_tissue final 'Bruise, coagulated spots, blood, and a membrane in front' assets/scenes/organ_tissue.json --time 3
picture mixed volume.colour 'An opened head: a quarter of the rays, under a mesh in full resolution' assets/scenes/mixed.json
picture stereo volume.colour 'The same for two eyes, side by side' assets/scenes/stereo.json
size=960x540 picture bleeding final 'Laparoscopy: a cut bleeds, an artery in it spurts, blood runs down and gathers' assets/scenes/laparoscopy.json --time 2
size=960x540 picture haemostasis final 'Five seconds later: a hook coagulates along the cut, and the bleeding stops' assets/scenes/laparoscopy.json --time 7
