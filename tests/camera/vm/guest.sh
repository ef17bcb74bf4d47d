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

# libcamera names a USB camera after the nearest ancestor with a firmware node, and the simulated host controller, a
# platform device, has none: lay one over sysfs, and let libudev accept files that are not sysfs's own.
give_simulated_host_a_firmware_node() {
  local node=/run/firmware/vhci_hcd.0/firmware_node
  mkdir -p "$node"
  printf '\\_SB_.SIM0\n' >"$node/path"
  mount -t overlay -o lowerdir=/run/firmware:/sys/devices/platform firmware /sys/devices/platform
  export SYSTEMD_DEVICE_VERIFY_SYSFS=0
}

if [ "$UDEV" = yes ]; then
  SYSTEMD_IN_CHROOT=0 /lib/systemd/systemd-udevd --daemon >/dev/null 2>&1 || { echo "guest: no udevd"; finish 125; }
fi
for module in "${MODULES[@]}"; do
  # shellcheck disable=SC2086 # the module's parameters follow its name
  modprobe $module || { echo "guest: modprobe $module failed"; finish 125; }
done
if [ "$UDEV" = yes ]; then
  [ ! -d /sys/devices/platform/vhci_hcd.0 ] || give_simulated_host_a_firmware_node
  udevadm trigger --subsystem-match=video4linux --subsystem-match=media --subsystem-match=usb
  udevadm settle --timeout=30
fi
cd "$DIRECTORY" || finish 125
"${COMMAND[@]}"
finish $?
