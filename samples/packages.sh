# Sourced by samples/demo.sh and tests/run.sh: install_packages NAME... installs the Debian packages that are missing.

# What the command needs to be built.
HDR_BUILD_PACKAGES=(build-essential cmake ninja-build pkg-config ccache
  libopenimageio-dev libopenexr-dev libimath-dev libtiff-dev libraw-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-video-dev libopencv-features2d-dev libopencv-calib3d-dev
  libceres-dev libeigen3-dev libtbb-dev zlib1g-dev libembree-dev libassimp-dev libhwy-dev libcli11-dev libfmt-dev
  nlohmann-json3-dev)

# What its tests need besides.
HDR_TEST_PACKAGES=(libgtest-dev librapidcheck-dev openimageio-tools ca-certificates)

# A browser in which its reports are looked at (tests/browser). Without it those tests are skipped, and say so.
HDR_BROWSER_PACKAGES=(chromium python3)

# What `hdr bench` and the programs of tests/bench measure against, and with; without it they run, and say what is not
# there. Other rivals are looked for when they run: pfstools, luminance-hdr, openimageio-tools, blender.
HDR_BENCH_PACKAGES=(libopencv-photo-dev libbenchmark-dev)

# The compiler whose libFuzzer tests/sanitize.sh runs.
HDR_FUZZ_PACKAGES=(clang)

# What its tests with real camera drivers need besides (tests/camera): cameras through libcamera, and a virtual machine,
# whose kernel is fetched but not installed. Without them those tests are skipped, and say so.
HDR_CAMERA_PACKAGES=(libcamera-dev qemu-system-x86 busybox-static cpio kmod python3 udev)

# Runs as root: directly, or through sudo.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

install_packages() {
  local missing=() name
  for name in "$@"; do
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" != installed ]; then missing+=("$name"); fi
  done
  if [ ${#missing[@]} = 0 ]; then return 0; fi
  echo "Installing Debian packages: ${missing[*]}"
  if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
    echo "This needs root: run  apt-get install ${missing[*]}  as root, then start again." >&2
    return 1
  fi
  as_root apt-get -qq -o DPkg::Lock::Timeout=600 update
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o DPkg::Lock::Timeout=600 \
    install --no-install-recommends "${missing[@]}" >/dev/null
}
