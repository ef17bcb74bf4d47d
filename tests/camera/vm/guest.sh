#!/bin/bash
# Runs the job of vm.sh inside the guest, as its first process: drivers, udevd when asked, the command, power off.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 HDR_IN_VM=1
exec </dev/null

finish() {
  echo "$1" >/run/share/status
  sync
  busybox poweroff -f
}
# The only serial port besides the console is vm.sh's standard output.
for port in /sys/class/virtio-ports/*; do exec >"/dev/${port##*/}" 2>&1; done
source /run/share/job

# libcamera names a USB camera after the nearest ancestor in sysfs with a firmware node, and the simulated host controller,
# a platform device, has none above it: give the root of sysfs one. Its folders are bound onto a memory file system, so all
# below them is sysfs's own, as udev demands.
give_sysfs_a_firmware_node() {
  mkdir /run/sysfs && mount -t sysfs sysfs /run/sysfs && mount -t tmpfs -o mode=755 sysfs /sys || return
  local folder
  for folder in /run/sysfs/*; do
    mkdir "/sys/${folder##*/}" && mount --bind "$folder" "/sys/${folder##*/}" || return
  done
  mkdir /sys/firmware_node && printf '\\_SB_\n' >/sys/firmware_node/path
}

if [ "$UDEV" = yes ]; then
  give_sysfs_a_firmware_node || { echo "guest: no firmware node"; finish 125; }
  SYSTEMD_IN_CHROOT=0 /lib/systemd/systemd-udevd --daemon >/dev/null 2>&1 || { echo "guest: no udevd"; finish 125; }
fi
for module in "${MODULES[@]}"; do
  # shellcheck disable=SC2086 # the module's parameters follow its name
  modprobe $module || { echo "guest: modprobe $module failed"; finish 125; }
done
if [ "$UDEV" = yes ]; then
  udevadm trigger --subsystem-match=video4linux --subsystem-match=media --subsystem-match=usb
  udevadm settle --timeout=30
fi
cd "$DIRECTORY" || finish 125
"${COMMAND[@]}"
finish $?
