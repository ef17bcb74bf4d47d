#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test through ctest. This is what CI runs.
set -euo pipefail
cd "$(dirname "$0")/.."
source samples/packages.sh
install_packages "${HDR_BUILD_PACKAGES[@]}" "${HDR_TEST_PACKAGES[@]}" "${HDR_BENCH_PACKAGES[@]}"
# Neither a browser nor cameras are worth a red run where they cannot be had.
install_packages "${HDR_BROWSER_PACKAGES[@]}" ||
  echo "browser tests: not all of these could be installed: ${HDR_BROWSER_PACKAGES[*]}"
install_packages "${HDR_CAMERA_PACKAGES[@]}" ||
  echo "camera tests: not all of these could be installed: ${HDR_CAMERA_PACKAGES[*]}"
tests/camera/vm.sh --prepare || echo "camera tests: those with real drivers are skipped, see the line above"

cmake --preset ci -DHDR_BUILD_TESTS=ON >/dev/null
cmake --build build/release
ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
