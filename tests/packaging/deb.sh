#!/usr/bin/env bash
# deb.sh BUILD: makes the Debian packages, asks apt whether they could be installed here, and runs what they hold.
# With HDR_TEST_INSTALL=1, as root, they are installed for good and the command is run from /usr/bin.
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$build" && cpack -B "$work/packages" >"$work/log") || { cat "$work/log"; exit 1; }
tools=$(ls "$work"/packages/hdr_*.deb)
dev=$(ls "$work"/packages/libhdr-dev_*.deb)
ls -l "$tools" "$dev"

echo "-- dependencies of the command, as read from it"
depends=$(dpkg-deb -f "$tools" Depends)
echo "$depends"
for library in libopenimageio libopencv-calib3d libembree libtbb; do
  [[ $depends == *$library* ]] || { echo "$library is missing from Depends" >&2; exit 1; }
done

echo "-- apt would install both"
apt-get -qq --simulate install "$tools" "$dev" >"$work/log" || { cat "$work/log"; exit 1; }

echo "-- the packaged command runs"
dpkg-deb -x "$tools" "$work/root"
"$work/root/usr/bin/hdr" --version
if [ -n "$(find "$work/root/usr/bin/hdr" -size +60M)" ]; then
  echo "the packaged command is over 60 MB: it was not stripped" >&2
  exit 1
fi

if [ "${HDR_TEST_INSTALL:-}" = 1 ]; then
  echo "-- installed"
  DEBIAN_FRONTEND=noninteractive apt-get -qq -y install "$tools" "$dev" >/dev/null
  /usr/bin/hdr --version
fi
