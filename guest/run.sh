#!/usr/bin/env bash
# Tests `cg run` on real SocketCAN: boots a kernel with vcan in QEMU, plays a drive, loads the bus, takes
# the interface down, kills the program, and checks the results. This machine needs no AF_CAN.
# Usage: guest/run.sh, after guest/image.sh
set -euo pipefail
cd "$(dirname "$0")/.."
work=target/guest

# The console is on the first serial port, the files of the test come as a tar on the second one.
# `-cpu max`, because numpy needs a recent processor. A run takes some five minutes, and beside other tests on a slow machine more than
# ten; the limit only ends one that hangs.
timeout 2400 qemu-system-x86_64 -cpu max -kernel "$work/kernel" -initrd "$work/initramfs.gz" \
  -append "console=ttyS0 panic=-1 quiet" -display none -monitor none -m 1536 -smp 2 -no-reboot \
  -serial "file:$work/console.txt" -serial "file:$work/results.tar" ||
  { tail -n 40 "$work/console.txt"; echo "guest: QEMU failed"; exit 1; }
mkdir -p "$work/results"
tar -xf "$work/results.tar" -C "$work/results" 2>/dev/null ||
  { tail -n 40 "$work/console.txt"; echo "guest: no results"; exit 1; }
python3 guest/check.py "$work"
