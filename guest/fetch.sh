#!/usr/bin/env bash
# Installs what guest/run.sh needs, and unpacks a kernel with vcan and can-utils into target/guest-packages.
set -euo pipefail
cd "$(dirname "$0")/.."
unpacked=target/guest-packages

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }
need() { command -v "$1" >/dev/null || missing+=("$2"); }
missing=()
need qemu-system-x86_64 qemu-system-x86
need busybox busybox-static
need cpio cpio
need kmod kmod
need python3 python3
if [ ${#missing[@]} -gt 0 ]; then
  as_root apt-get update -q
  as_root apt-get install -y -q --no-install-recommends "${missing[@]}"
fi
[ ! -d "$unpacked" ] || exit 0

# The kernel and can-utils are unpacked, not installed.
rm -rf "$unpacked.new"
mkdir -p "$unpacked.new"
(
  cd "$unpacked.new"
  image=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/.*Depends: \(linux-image-[^ ]*\)/\1/p' | head -n 1)
  if [ -z "$image" ]; then
    as_root apt-get update -q
    image=$(apt-cache depends linux-image-amd64 | sed -n 's/.*Depends: \(linux-image-[^ ]*\)/\1/p' | head -n 1)
  fi
  apt-get download -q "$image" can-utils
  for package in ./*.deb; do dpkg -x "$package" .; done
  rm ./*.deb
)
mv "$unpacked.new" "$unpacked"
