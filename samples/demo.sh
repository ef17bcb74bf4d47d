#!/usr/bin/env bash
# From photographs of a mirror ball to a picture lit by them.
#   samples/demo.sh            photographs a ball standing in a real place, and measures the probe against the truth
#   samples/demo.sh FILES...   the same from your own photographs (one mirror ball, several exposures, EXIF times)
# The first run installs what is missing and builds; a second one takes under a minute.
set -euo pipefail
photographs=()
for file in "$@"; do photographs+=("$(realpath "$file")"); done
cd "$(dirname "$0")/.."
source samples/packages.sh
source samples/world.sh

install_packages "${HDR_BUILD_PACKAGES[@]}"
if [ ! -f build/release/build.ninja ]; then cmake --preset release -DHDR_BUILD_TESTS=OFF >/dev/null; fi
cmake --build build/release --target hdr | tail -n 1

hdr=$PWD/build/release/hdr
work=$PWD/build/demo
out=$work/pictures
mkdir -p "$out"
stages=()

# stage NAME COMMAND...: runs it and remembers its seconds.
stage() {
  local name=$1 start end
  shift
  echo "== $name: $(basename "$1") ${*:2}" | sed "s|$PWD/||g"
  start=$(date +%s.%N)
  "$@"
  end=$(date +%s.%N)
  stages+=("$(awk -v a="$start" -v b="$end" -v n="$name" 'BEGIN { printf "  %-10s %6.1f s", n, b - a }')")
}

world=$work/world.exr
if [ ${#photographs[@]} = 0 ]; then
  [ -f "$world" ] || get_world "$world"
  rm -rf "$work/shots"
  # Seven shots 2 EV apart, and one off that grid: steps that are all alike leave the response ambiguous.
  stage simulate "$hdr" simulate "$world" --ball --ball-radius 680 --size 2000x1500 -o "$work/shots" --quiet \
    --times 1/8000,1/2000,1/500,1/125,1/80,0.032,0.128,0.512 --level 0.03 --response film --shift 3 --seed 7
  photographs=("$work/shots")
fi

stage probe "$hdr" probe "${photographs[@]}" -o "$out/probe.exr" --width 1024 --save-response "$out/response.json"
stage sh "$hdr" sh "$out/probe.exr" -o "$out/sh.json" --irradiance-map "$out/irradiance.exr"
stage render "$hdr" render --probe "$out/probe.exr" -o "$out/render.exr" --samples 64
for picture in probe irradiance render; do "$hdr" tonemap "$out/$picture.exr" -o "$out/$picture.png" --quiet; done

echo
echo "Seconds per stage:"
printf '%s\n' "${stages[@]}"
echo "Pictures: $out/probe.png, irradiance.png, render.png (and the same as .exr; response.json, sh.json)"
if [ -d "$work/shots" ] && [ "${photographs[0]}" = "$work/shots" ]; then
  # The camera leaves white balance free (g = 0 at the middle code), so one scale a channel; the photographer's direction and
  # the blind spot behind the ball do not count.
  "$hdr" diff "$out/probe.exr" "$world" --scale channel --ignore-cones 15 --json |
    awk -F'[:,]' '/"median_abs_log2"/ { m = $2 } /"p99_abs_log2"/ { p = $2 }
      END { printf "probe against truth: median %.3f p99 %.3f (log2)\n", m, p }'
fi
