#!/usr/bin/env bash
# Blurs, exposure and spherical harmonics on a light probe and on an 8-bit picture of it, one picture for each.
#   samples/hdr_versus_ldr.sh [PROBE.exr]      the pictures: build/hdr_versus_ldr/*.png
set -euo pipefail
probe=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."
source samples/packages.sh
source samples/world.sh
install_packages "${HDR_BUILD_PACKAGES[@]}" "${HDR_TEST_PACKAGES[@]}"
cmake --preset release -DHDR_BUILD_TESTS=ON >/dev/null
cmake --build build/release --target hdr_versus_ldr | tail -n 1
work=$PWD/build/hdr_versus_ldr
mkdir -p "$work"
if [ -z "$probe" ]; then
  probe=$work/world.exr
  if [ ! -f "$probe" ]; then get_world "$probe"; fi
fi
build/release/samples/hdr_versus_ldr "$probe" "$work"
