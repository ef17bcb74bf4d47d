"""unpack_kernel.py BZIMAGE ELF: the kernel inside a bzImage, so that an emulated processor need not unpack it at each boot.

The boot protocol (Documentation/x86/boot.rst) gives the number of set-up sectors at 0x1f1, and the payload's offset and
length, counted from the protected-mode code, at 0x248. Debian compresses with xz.
"""
import lzma
import struct
import sys

image = open(sys.argv[1], "rb").read()
setup_bytes = ((image[0x1F1] or 4) + 1) * 512
offset, length = struct.unpack_from("<II", image, 0x248)
payload = image[setup_bytes + offset : setup_bytes + offset + length]
elf = lzma.LZMADecompressor().decompress(payload)
if elf[:4] != b"\x7fELF":
    sys.exit(f"{sys.argv[1]}: the payload is not an xz-compressed ELF kernel")
open(sys.argv[2], "wb").write(elf)
