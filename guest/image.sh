#!/usr/bin/env bash
# Makes what guest/run.sh boots and compares with: a kernel, the initial file system with the program, and the drives.
# Usage: guest/image.sh CG_BINARY VENV   (VENV: the environment of `make venv`, for the test with python-can)
set -euo pipefail
cd "$(dirname "$0")/.."
cg=$(realpath "$1")
venv=$(realpath "$2")
work=target/guest
packages=target/guest-packages
seconds=${CG_LOAD_SECONDS:-60}
rate=${CG_LOAD_RATE:-8000}
rm -rf "$work"
mkdir -p "$work/root"

guest/fetch.sh
cp "$(find "$packages/boot" -name 'vmlinuz-*')" "$work/kernel"
modules=$(find "$packages" -path '*/modules/*/kernel' -prune)

# A truck with a steering ratio, because J1939 carries the angle of the steering wheel; and its drive.
# The plant's road is flat, so the roll angle on the bus, which is relative to gravity, contains no bank.
sed 's/^nominal_speed_mps/steering_ratio = 20.0\n&/' fixtures/vehicles/kraz.toml > "$work/truck.toml"
printf '\n[road]\nbank_sd_rad = 0.0\n\n[sensors.tractor_level]\nspread_m = 1.0\n' >> "$work/truck.toml"
for log in csv log; do
  "$cg" simulate --vehicle "$work/truck.toml" --maneuver drive --duration-s 45 --seed 5 --snr-db 25 -o "$work/drive.$log"
done
# The same truck on a banked road, without any sensor on the trailer: levels and specific force of the tractor.
"$cg" simulate --vehicle "$work/truck.toml" --road rural --seed 2 --duration-s 60 -o "$work/road.log"
grep -v -e 0CF029E4 -e 0CF013E4 "$work/road.log" > "$work/tractor.log"
"$cg" run --candump "$work/tractor.log" --vehicle "$work/truck.toml" --status-s 0 > "$work/tractor.jsonl"
"$cg" run --csv "$work/drive.csv" --vehicle "$work/truck.toml" --status-s 0 > "$work/csv.jsonl"

# The initial file system.
root=$work/root
mkdir -p "$root"/{bin,lib,dev,proc,sys,kept,results}
cp "$(command -v busybox)" "$root/bin/busybox"
for applet in sh mount insmod ip sleep kill cat cut awk grep tail wc tar stty poweroff echo rm date seq dd; do
  ln -s busybox "$root/bin/$applet"
done
programs=("$cg")
for tool in candump canplayer cangen; do programs+=("$packages/usr/bin/$tool"); done
for program in "${programs[@]}"; do
  cp "$program" "$root/bin/"
  for library in $(ldd "$program" | grep -o '/[^ )]*'); do
    mkdir -p "$root$(dirname "$library")"
    cp -L "$library" "$root$library"
  done
done
for module in can can-raw can-dev vcan; do
  file=$(find "$modules" -name "$module.ko*")
  case $file in
    *.xz) xz -dc "$file" > "$root/lib/$module.ko" ;;
    *) cp "$file" "$root/lib/$module.ko" ;;
  esac
done
# Python and the packages that the listener needs, from the environment.
python=$("$venv/bin/python" -c 'import sys; print(sys.base_prefix)')
"$venv/bin/python" - "$root" <<'PYTHON'
import shutil, sys, sysconfig
from pathlib import Path

import can, numpy, packaging, typing_extensions, wrapt

import cgheight

root = Path(sys.argv[1])
library = Path(sysconfig.get_paths()["stdlib"])
leave = shutil.ignore_patterns(
    "site-packages", "test", "tests", "idlelib", "tkinter", "ensurepip", "config-*", "__pycache__", "*.a"
)
shutil.copytree(library, root / "python/lib" / library.name, ignore=leave)
site = root / "site"
for package in (can, numpy, packaging, wrapt, cgheight):
    folder = Path(package.__file__).parent
    shutil.copytree(folder, site / folder.name, ignore=leave)
libraries = Path(numpy.__file__).parent.parent / "numpy.libs"
if libraries.exists():
    shutil.copytree(libraries, site / libraries.name)
shutil.copy(typing_extensions.__file__, site)
PYTHON
mkdir -p "$root/python/bin"
cp -L "$python/bin/python3" "$root/python/bin/python3"
find "$root/python" "$root/site" -name '*.so*' -exec ldd {} + 2>/dev/null | cat - <(ldd "$root/python/bin/python3") |
  awk '$2 == "=>" && $3 ~ "^/" { print $3 } $1 ~ "^/" && $2 ~ "^[(]" { print $1 }' | sort -u |
  while read -r library; do
    case $library in "$venv"* | *"$work"*) continue ;; esac
    [ -e "$root$library" ] && continue
    mkdir -p "$root$(dirname "$library")"
    cp -L "$library" "$root$library"
  done
cp guest/listener.py "$root/"
cp guest/init "$root/init"
chmod +x "$root/init"
cp "$work/truck.toml" "$work/drive.log" "$work/tractor.log" "$root/"
printf 'seconds=%s\nrate=%s\ndowns=20\n' "$seconds" "$rate" > "$root/settings"
(cd "$root" && find . | cpio --quiet -o -H newc) | gzip -1 > "$work/initramfs.gz"
