#!/usr/bin/env bash
# Packs a program `cg` for Debian and Ubuntu, with the systemd unit; prints the name of the package.
# Usage: ports/deb/build.sh PROGRAM ARCHITECTURE FOLDER   (COMPRESSION=gzip for a quick one)
set -euo pipefail
program=$(realpath "$1")
architecture=$2
folder=$(realpath "$3")
cd "$(dirname "$0")/../.."
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"

put() { install -D -m "$1" "$2" "$work/$3"; }
put 755 "$program" usr/bin/cg
put 644 ports/deb/can0.env etc/cg-height/can0.env
put 644 systemd/cg-run@.service usr/lib/systemd/system/cg-run@.service
sed -i -e 's#/usr/local/bin/cg#/usr/bin/cg#' -e '/^# Install to/,/^# \/etc/c# Its options are in /etc/cg-height/can0.env.' \
  "$work/usr/lib/systemd/system/cg-run@.service"
for page in docs/live.md docs/vehicle.md docs/limits.md README.md; do put 644 "$page" "usr/share/doc/cg-height/${page##*/}"; done
gzip -9 --no-name < CHANGELOG.md > "$work/usr/share/doc/cg-height/changelog.gz"
cat LICENSE-MIT LICENSE-APACHE > "$work/usr/share/doc/cg-height/copyright"
for script in postinst prerm postrm; do put 755 "ports/deb/$script" "DEBIAN/$script"; done
sed -e "s/@VERSION@/$version/" -e "s/@ARCHITECTURE@/$architecture/" ports/deb/control > "$work/DEBIAN/control"
echo /etc/cg-height/can0.env > "$work/DEBIAN/conffiles"

made="$folder/cg-height_${version}_$architecture.deb"
dpkg-deb --root-owner-group -Z"${COMPRESSION:-xz}" --build "$work" "$made" >&2
echo "$made"
