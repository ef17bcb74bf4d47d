#!/usr/bin/env bash
# prepare.sh CACHE: leaves in CACHE what a guest starts from: Debian's kernel, unpacked, and a memory disk with the
# drivers that the tests need. Made once for each version of the kernel that apt offers at the time; exit 77 with one
# line when it cannot be had.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
cache=$1

skip() { echo "camera tests skipped: $*"; exit 77; }

# Name of a program, package that has it.
while read -r program package; do
  command -v "$program" >/dev/null || skip "$program is not installed; apt-get install $package"
done <<'PROGRAMS'
qemu-system-x86_64 qemu-system-x86
cpio cpio
depmod kmod
python3 python3
busybox busybox-static
PROGRAMS
busybox=$(command -v busybox)
[ -x /lib/systemd/systemd-udevd ] || skip "udevd is not installed; apt-get install udev"
if ldd "$busybox" >/dev/null 2>&1; then skip "busybox needs shared libraries; apt-get install busybox-static"; fi

mkdir -p "$cache" 2>/dev/null || skip "$cache cannot be made; set HDR_VM_CACHE"
exec 9>"$cache/lock"
flock 9
stamp=$(cat "$here/init" "$here/prepare.sh" "$here/unpack_kernel.py" | sha256sum | cut -d' ' -f1)
if [ "$(cat "$cache/stamp" 2>/dev/null)" = "$stamp" ]; then exit 0; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
offered_kernel() { apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image-[0-9]/ {print $2; exit}'; }
kernel_package=$(offered_kernel)
if [ -z "$kernel_package" ] && [ "$(id -u)" = 0 ]; then
  apt-get -qq -o DPkg::Lock::Timeout=600 update >/dev/null 2>&1 || true
  kernel_package=$(offered_kernel)
fi
[ -n "$kernel_package" ] || skip "apt offers no linux-image-amd64"
(cd "$work" && apt-get -qq -o DPkg::Lock::Timeout=600 -o APT::Sandbox::User=root download "$kernel_package") 2>"$work/error" ||
  skip "apt-get download $kernel_package: $(tail -n 1 "$work/error")"
dpkg-deb -x "$work"/*.deb "$work/package"
version=$(ls "$work/package/lib/modules")
python3 "$here/unpack_kernel.py" "$work/package/boot/vmlinuz-$version" "$cache/vmlinux"

# The memory disk holds the start-up drivers (in the order of their loading) and those that tests ask for.
root=$work/root
mkdir -p "$root"/{bin,proc,sys,dev,host,memory,guest} "$root/lib/modules/$version"
cp "$busybox" "$root/bin/busybox"
cp "$here/init" "$root/init"
chmod +x "$root/init"
depmod -b "$work/package" "$version"
copy_with_dependencies() {
  modprobe -d "$work/package" -S "$version" --show-depends "$1" | awk '$1 == "insmod" {print $2}' |
    while read -r file; do
      target=$root/lib/modules/$version/${file#"$work/package/lib/modules/$version/"}
      mkdir -p "$(dirname "$target")"
      cp "$file" "$target"
    done
}
for module in virtio_pci 9pnet_virtio 9p overlay virtio_console vhci-hcd uvcvideo vivid; do copy_with_dependencies "$module"; done
cp "$work/package/lib/modules/$version"/modules.{order,builtin,builtin.modinfo} "$root/lib/modules/$version/"
depmod -b "$root" "$version"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$cache/initrd.gz"
echo "$stamp" >"$cache/stamp"
