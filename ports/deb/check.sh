#!/usr/bin/env bash
# Installs a package of ports/deb/build.sh into a folder of its own, checks the unit, runs the program as the service
# does, upgrades, removes and purges it. Nothing of this machine changes.
# Usage: ports/deb/check.sh PACKAGE [RUNNER]   (RUNNER: an emulator such as qemu-aarch64)
set -euo pipefail
cd "$(dirname "$0")/../.."
package=$1
runner=${2:-}
work=$(mktemp -d)
root=$work/root

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }
trap 'as_root rm -rf "$work"' EXIT
fail() { echo "$package: $*" >&2; exit 1; }
# The scripts of the package run without chroot and find the folder in DPKG_ROOT. Foreign architectures are welcome.
dpkg_in_root() {
  as_root env PATH="$PATH:/usr/sbin:/sbin" dpkg --root="$root" --log="$work/log" --force-script-chrootless \
    --force-architecture --force-depends "$@" >> "$work/output" 2>&1 || { cat "$work/output"; fail "dpkg $*"; }
}
listing() { (cd "$root" && find . -path ./var/lib/dpkg -prune -o -print | LC_ALL=C sort); }
cg() { $runner "$root/usr/bin/cg" "$@"; }

mkdir -p "$root"/var/lib/dpkg/{info,updates,triggers} "$root"/etc/systemd/system/multi-user.target.wants "$root"/var/lib/private
touch "$root/var/lib/dpkg/status"
listing > "$work/before"

dpkg_in_root --install "$package"
[ "$(find "$root/etc/systemd/system" -name 'cg-run*')" = "" ] || fail "the installation enables the service"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
[ "$(cg --version)" = "cg $version" ] || fail "cg --version says $(cg --version)"

# The unit, with the units of this machine that it refers to.
for folder in /usr/lib/systemd/system /lib/systemd/system; do
  [ ! -d "$folder" ] || units=$folder
done
mkdir "$work/units"
find "$units" -maxdepth 1 \( -name '*.target' -o -name '*.slice' -o -name '*.socket' \) -exec cp -t "$work/units" {} +
sed "s#/usr/bin/cg#$root/usr/bin/cg#" "$root/usr/lib/systemd/system/cg-run@.service" > "$work/units/cg-run@.service"
ln -s cg-run@.service "$work/units/cg-run@can0.service"
said=$(SYSTEMD_UNIT_PATH="$work/units" systemd-analyze verify --man=no "$work/units/cg-run@can0.service" 2>&1) \
  && [ -z "$said" ] || fail "systemd-analyze verify: $said"

# The program with the options of the unit and of its environment, a recorded drive in place of the bus. The paths of the
# installed system are those of the folder.
as_root cp fixtures/vehicles/kraz.toml "$root/etc/cg-height/truck.toml"
as_root mkdir "$root/var/lib/private/cg-height"
as_root ln -s private/cg-height "$root/var/lib/cg-height"
as_root ln -s /usr/lib/systemd/system/cg-run@.service "$root/etc/systemd/system/multi-user.target.wants/cg-run@can0.service"
as_root chown -R "$(id -u)" "$root/var/lib/private/cg-height"
command=$(sed -n 's/^ExecStart=//p' "$root/usr/lib/systemd/system/cg-run@.service")
options=$(sed -n "s#^CG_OPTIONS=##p" "$root/etc/cg-height/can0.env")
command=${command//--can %i/--csv fixtures/logs/A_p20_h190_v50_L.csv}
command=${command//\$\{STATE_DIRECTORY\}/\/var\/lib\/cg-height}
command=${command//%i/can0}
command=${command//\$CG_OPTIONS/$options}
command=$(sed -E "s# /(usr|etc|var)/# $root/\1/#g" <<< " $command")
# shellcheck disable=SC2086 # the options of the service are words
$runner $command > "$work/events" || fail "$command"
grep -q '"event":"maneuver"' "$work/events" || fail "no maneuver in $(cat "$work/events")"
[ -s "$root/var/lib/cg-height/can0.json" ] || fail "no state was saved"

# What was configured survives an upgrade and a removal.
echo '# edited' | as_root tee -a "$root/etc/cg-height/can0.env" >/dev/null
dpkg_in_root --install "$package"
dpkg_in_root --remove cg-height
grep -q '# edited' "$root/etc/cg-height/can0.env" || fail "the configuration was replaced"
[ ! -e "$root/usr/bin/cg" ] || fail "the program stays after its removal"
[ -s "$root/var/lib/cg-height/can0.json" ] || fail "the state is lost by a removal"
dpkg_in_root --purge cg-height
[ -e "$root/etc/cg-height/truck.toml" ] || fail "the vehicle file of the user is lost"
as_root rm -r "$root/etc/cg-height"
diff "$work/before" <(listing) || fail "something is left after the purge"
echo "$package: installed, run, upgraded, removed and purged"
