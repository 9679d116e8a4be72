"""Checks that `cg` for another system answers as the one for this machine does.

    python3 ports/compare.py [--left-out] [--quick] REFERENCE [RUNNER ...] PROGRAM

Both programs run the same commands, each in a folder of its own. Exit status, both output streams and every file that
was written must be the same, except for the last digits of numbers. With `--left-out`, the program has no optional
feature and must name the one that a command needs. `--quick` leaves out what takes an emulator half a minute.
"""

import argparse
import gzip
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

FIXTURES = Path(__file__).resolve().parent.parent / "fixtures"
INPUTS = (
    "vehicles/kraz.toml",
    "logs/A_p00_v50_L.csv",
    "logs/A_p20_h190_v50_L.csv",
    "logs/F_drive1_p15_h155.csv.gz",
)
KRAZ = ("--vehicle", "kraz.toml")

# Each command may read what those before it have written, and what the reference has written, as `reference.…`: the
# calibrations of two computers differ by more than their estimates (the search ends when its steps are small), and a
# state must hold on another computer.
COMMANDS = {
    "version": ("--version",),
    "new vehicle": ("vehicle", "new", "--kind", "4x2-3axle", "-o", "truck.toml"),
    "check": ("vehicle", "check", "truck.toml", "--format", "json"),
    "model": ("model", *KRAZ, "--format", "json"),
    "design": ("design", *KRAZ, "--emit", "json", "-o", "design.json"),
    "calibrate": (
        "calibrate", *KRAZ, "--run", "A_p00_v50_L.csv=empty", "--run", "A_p20_h190_v50_L.csv=1.90", "-o", "calibration.toml",
    ),
    "estimate": (
        "estimate", "A_p00_v50_L.csv", "A_p20_h190_v50_L.csv", "F_drive1_p15_h155.csv.gz", *KRAZ, "--format", "json",
        "--report", "report.html",
    ),
    "estimate, calibrated": (
        "estimate", "F_drive1_p15_h155.csv.gz", *KRAZ, "--calibration", "reference.calibration.toml", "--format", "json",
    ),
    "simulate": (
        "simulate", "--vehicle", "truck.toml", "--maneuver", "drive", "--duration-s", "45", "--seed", "5",
        "--snr-db", "25", "-o", "drive.csv", "--truth", "truth.json",
    ),
    "simulate, compressed": ("simulate", *KRAZ, "--maneuver", "sine", "--duration-s", "10", "-o", "sine.csv.gz"),
    "simulate, frames": (
        "simulate", "--vehicle", "truck.toml", "--road", "rural", "--seed", "2", "--duration-s", "20", "-o", "road.log",
    ),
    "replay of rows": ("run", "--csv", "drive.csv", "--vehicle", "truck.toml", "--status-s", "10"),
    "replay of frames": (
        "run", "--candump", "road.log", "--vehicle", "truck.toml", "--state", "state.json",
        "--status-s", "5",
    ),
    "replay from a state": (
        "run", "--candump", "road.log", "--vehicle", "truck.toml", "--state", "reference.state.json", "--status-s", "0",
    ),
    "rollover": ("rollover", *KRAZ, "--payload-kg", "20000", "--height-m", "1.9", "--format", "json"),
    "a column that is missing": ("estimate", "A_p00_v50_L.csv", *KRAZ, "--column", "roll=Other[deg]"),
    "an output that is an input": ("simulate", *KRAZ, "--maneuver", "sine", "-o", "kraz.toml"),
}  # fmt: skip

# What a program without optional features cannot do, with the feature.
OPTIONAL = {
    "parquet": ("estimate", "drive.parquet", *KRAZ),
    "dbc": ("estimate", "-", *KRAZ, "--dbc", "j1939.dbc", "--signal", "roll=SSI2.RollAngle"),
    "plots": ("study", "height", "--output", "nowhere"),
}  # fmt: skip

NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])")
# What tells when it was written, and the checksums over it.
DATED = re.compile(rb'^date = ".*"$|^(?:# )?crc32 \w+$|\d{4}-\d\d-\d\d \d\d:\d\d UTC', re.MULTILINE)
# The greatest difference of two numbers, as a share of them. The exponential function of another C library and sums in
# another order (SIMD) differ by some 1e-16. Least squares and reductions multiply this by the condition number of their
# matrices, which may be a million. Single precision alone would give 6e-8 in every number.
RELATIVE = 1e-10
# The search of a calibration ends where its sum of squares is flat to 1e-16, which leaves its parameters open by the root
# of it.
SEARCHED = {"calibration.toml": 1e-8}
# Numbers below this times their usual size are differences of others: signals through zero, coefficients that vanish.
SMALL = 1e-3


def answers(
    program: list[str], folder: Path, commands: dict[str, tuple], reference: dict[str, bytes] | None = None
) -> dict[str, bytes]:
    """What the program prints and writes, by command and by file; `reference` is the same of the other program."""
    for name in INPUTS:
        shutil.copy(FIXTURES / name, folder)
    found = {}
    for name, arguments in commands.items():
        before = {path.name for path in folder.iterdir()}
        for written in (argument.removeprefix("reference.") for argument in arguments if argument.startswith("reference.")):
            (folder / f"reference.{written}").write_bytes((reference or found)[written])
        done = ended([*program, *arguments], folder)
        found[name] = b"exit status %d\n" % done.returncode + done.stdout + done.stderr
        found |= {path.name: content(path) for path in sorted(folder.iterdir()) if path.name not in before}
    return found


def ended(command: list[str], folder: Path) -> subprocess.CompletedProcess[bytes]:
    """Run a command in a folder until it ends by itself.

    Wine 8 kills one in thirty programs that have a second thread (here the one for Ctrl-C) while they end, in place of
    that thread. Such a command is run again in the folder as it was; seven times in a row are no accident (1 in 3e10).
    """
    before = {path: path.read_bytes() for path in folder.iterdir()}
    for _ in range(7):
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=600, stdin=subprocess.DEVNULL)
        if done.returncode != -signal.SIGKILL:
            break
        for path in folder.iterdir():
            path.unlink()
        for path, data in before.items():
            path.write_bytes(data)
    return done


def content(path: Path) -> bytes:
    """The bytes of a file, decompressed."""
    return gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()


def undated(text: bytes) -> bytes:
    """A text without what tells when it was written."""
    return DATED.sub(b"", text)


def difference(one: bytes, other: bytes) -> float:
    """The greatest difference of two numbers as a share of them; infinite if anything but numbers differs."""
    one, other = undated(one), undated(other)
    if NUMBER.sub(b"", one) != NUMBER.sub(b"", other):
        return float("inf")
    pairs = zip(map(float, NUMBER.findall(one)), map(float, NUMBER.findall(other)), strict=True)
    return max((abs(a - b) / (max(abs(a), abs(b)) + SMALL) for a, b in pairs), default=0.0)


def worst_line(one: bytes, other: bytes) -> str:
    """The line that differs most."""
    pairs = list(zip(one.splitlines(), other.splitlines(), strict=False))
    if len(one.splitlines()) != len(other.splitlines()):
        pairs = [pair for pair in pairs if difference(*pair) > RELATIVE][:1] or pairs[-1:]
    ours, theirs = max(pairs, key=lambda pair: difference(*pair), default=(one, other))
    at = next((k for k in range(len(ours)) if difference(ours[:k], theirs[:k]) > RELATIVE), len(ours))
    begin = max(0, at - 60)
    return f"  here:  {ours[begin : at + 60]!r}\n  there: {theirs[begin : at + 60]!r}"


def features_missing(program: list[str]) -> list[str]:
    """What is wrong with a program without optional features."""
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        for name in ("vehicles/kraz.toml", "can/j1939.dbc"):
            shutil.copy(FIXTURES / name, folder)
        (Path(folder) / "drive.parquet").write_text("PAR1")
        for feature, arguments in OPTIONAL.items():
            done = ended([*program, *arguments], Path(folder))
            if done.returncode != 2 or done.stdout or f"feature `{feature}`".encode() not in done.stderr:
                faults.append(f"{feature}: exit status {done.returncode}, {done.stdout}{done.stderr}")
        if (Path(folder) / "nowhere").exists():
            faults.append("plots: a folder without figures is made")
    return faults


def main() -> None:
    """Runs both programs and prints what differs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--left-out", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("reference", type=Path)
    parser.add_argument("program", nargs="+")
    options = parser.parse_args()
    commands = {name: line for name, line in COMMANDS.items() if not (options.quick and name == "rollover")}
    # The programs run in folders of their own.
    program = [*options.program[:-1], str(Path(options.program[-1]).resolve())]
    with tempfile.TemporaryDirectory() as here, tempfile.TemporaryDirectory() as there:
        ours = answers([str(options.reference.resolve())], Path(here), commands)
        theirs = answers(program, Path(there), commands, ours)
    faults = [f"{name}: only {'here' if name in ours else 'there'}" for name in sorted(ours.keys() ^ theirs.keys())]
    apart = {name: difference(ours[name], theirs[name]) for name in ours if name in theirs}
    faults += [
        f"{name}: differs by {share:.1e}\n{worst_line(ours[name], theirs[name])}"
        for name, share in apart.items()
        if share > SEARCHED.get(name, RELATIVE)
    ]
    faults += features_missing(program) if options.left_out else []
    if faults:
        sys.exit("\n".join(faults))
    size = sum(map(len, ours.values()))
    same = sum(undated(ours[name]) == undated(theirs[name]) for name in ours)
    name = max(apart, key=apart.get)
    print(f"{len(ours)} answers and files of {size} bytes: {same} are equal to the last byte,", end=" ")
    print(f"in the others numbers differ by at most {apart[name]:.1e} ({name})")


if __name__ == "__main__":
    main()
