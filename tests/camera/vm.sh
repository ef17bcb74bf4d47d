#!/usr/bin/env bash
# Runs a command in a virtual machine that boots Debian's own kernel, so that tests meet the real uvcvideo, vivid and
# libcamera on any machine. The guest sees this machine's files at the same paths, read-only below a memory file system:
# what it writes vanishes. Its output and exit code are the command's.
#
#   vm.sh [--module 'NAME [PARAMETER=VALUE...]']... [--udev] [--timeout SECONDS] -- COMMAND [ARGUMENT...]
#   vm.sh --prepare          only fetch the kernel and make the guest's start-up files
#
# --udev starts udevd, without which libcamera finds no device. HDR_VM_CACHE: where the kernel is kept.
# Exit: the command's own; 77 when this machine cannot have the virtual machine (one line says why); 124 after --timeout;
# 125 when the guest failed before the command could run.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
cache=${HDR_VM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/hdr-vm}
timeout_seconds=300

MODULES=() COMMAND=() UDEV=no DIRECTORY=$PWD
while [ $# -gt 0 ]; do
  case $1 in
    --module) MODULES+=("$2"); shift 2 ;;
    --udev) UDEV=yes; shift ;;
    --timeout) timeout_seconds=$2; shift 2 ;;
    --prepare) exec "$here/vm/prepare.sh" "$cache" ;;
    --) shift; COMMAND=("$@"); break ;;
    *) echo "vm.sh: unknown option $1" >&2; exit 125 ;;
  esac
done
[ ${#COMMAND[@]} -gt 0 ] || { echo "vm.sh: no command; see the head of this file" >&2; exit 125; }
"$here/vm/prepare.sh" "$cache"

share=$(mktemp -d)
trap 'rm -rf "$share"' EXIT
cp "$here/vm/guest.sh" "$share/"
declare -p MODULES UDEV DIRECTORY COMMAND >"$share/job"

# TCG always: a /dev/kvm that exists may still hang a stock kernel (nested virtualisation).
machine=(-M "q35,usb=off,smbus=off" -accel "tcg,thread=multi" -cpu max,-la57 -smp 2 -m 1536
  -nodefaults -no-user-config -display none -no-reboot)
kernel=(-kernel "$cache/vmlinux" -initrd "$cache/initrd.gz"
  -append "console=ttyS0 panic=-1 quiet mitigations=off nokaslr random.trust_cpu=on tsc=reliable no_timer_check nmi_watchdog=0")
files=(-fsdev "local,id=root,path=/,security_model=none,multidevs=remap,readonly=on" -device "virtio-9p-pci,fsdev=root,mount_tag=root"
  -fsdev "local,id=share,path=$share,security_model=none" -device "virtio-9p-pci,fsdev=share,mount_tag=share")
output=(-serial "file:$share/console" -device virtio-serial-pci
  -chardev "file,id=out,path=/dev/stdout" -device "virtserialport,chardev=out,name=out")

# QEMU opens and empties /dev/stdout, which a pipe survives and a log file would not.
set +e
timeout -k 5 "$timeout_seconds" qemu-system-x86_64 "${machine[@]}" "${kernel[@]}" "${files[@]}" "${output[@]}" \
  </dev/null 2>"$share/qemu" | cat
status=${PIPESTATUS[0]}
set -e
if [ -s "$share/status" ]; then exit "$(cat "$share/status")"; fi
if [ "$status" = 124 ] || [ "$status" = 137 ]; then
  echo "vm.sh: stopped after $timeout_seconds s" >&2
  status=124
else
  echo "vm.sh: the guest ended before the command did" >&2
  status=125
fi
{ echo "The guest's console:"; tail -n 30 "$share/console" 2>/dev/null | tr -d '\r'; cat "$share/qemu"; } >&2
exit "$status"
