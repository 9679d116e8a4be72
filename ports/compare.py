"""Checks that `cg` for another system answers as the one for this machine does.

    python3 ports/compare.py [--left-out] [--quick] REFERENCE [RUNNER ...] PROGRAM

Both programs run the same commands, each in a folder of its own. Exit status, both output streams and every file that
was written must be the same to the last byte: `libm` and `cg_vehicle::matrix` give the same bits on every computer, and the
compiler keeps the order of operations. With `--left-out`, the program has no optional
feature and must name the one that a command needs. `--quick` leaves out what takes an emulator long, except one estimate, one simulation and one replay.
"""

import argparse
import gzip
import os
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

# Each command may read what those before it have written.
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
        "estimate", "F_drive1_p15_h155.csv.gz", *KRAZ, "--calibration", "calibration.toml", "--format", "json",
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
        "run", "--candump", "road.log", "--vehicle", "truck.toml", "--state", "state.json", "--status-s", "0",
    ),
    "rollover": ("rollover", *KRAZ, "--payload-kg", "20000", "--height-m", "1.9", "--format", "json"),
    "a column that is missing": ("estimate", "A_p00_v50_L.csv", *KRAZ, "--column", "roll=Other[deg]"),
    "an output that is an input": ("simulate", *KRAZ, "--maneuver", "sine", "-o", "kraz.toml"),
}  # fmt: skip

# What the others do as well, and what takes an emulator 20 s or more.
LONG = {
    "design", "calibrate", "estimate, calibrated", "replay of rows", "replay from a state", "rollover",
    "a column that is missing",
}  # fmt: skip

# What a program without optional features cannot do, with the feature.
OPTIONAL = {
    "parquet": ("estimate", "drive.parquet", *KRAZ),
    "dbc": ("estimate", "-", *KRAZ, "--dbc", "j1939.dbc", "--signal", "roll=SSI2.RollAngle"),
    "plots": ("study", "height", "--output", "nowhere"),
}  # fmt: skip

# What tells when it was written, and the checksums over it.
DATED = re.compile(rb'^date = ".*"$|^(?:# )?crc32 \w+$|\d{4}-\d\d-\d\d \d\d:\d\d UTC', re.MULTILINE)


def answers(program: list[str], folder: Path, commands: dict[str, tuple]) -> dict[str, bytes]:
    """What the program prints and writes, by command and by file, without what tells when it was written."""
    for name in INPUTS:
        shutil.copy(FIXTURES / name, folder)
    found = {}
    for name, arguments in commands.items():
        before = {path.name for path in folder.iterdir()}
        done = ended([*program, *arguments], folder)
        found[name] = b"exit status %d\n" % done.returncode + done.stdout + done.stderr
        found |= {path.name: content(path) for path in sorted(folder.iterdir()) if path.name not in before}
    return {name: DATED.sub(b"", text) for name, text in found.items()}


def ended(command: list[str], folder: Path) -> subprocess.CompletedProcess[bytes]:
    """Run a command in a folder until it ends by itself.

    Wine 8 kills one in thirty programs that have a second thread (here the one for Ctrl-C) while they end, in place of
    that thread. On a busy machine that thread may also find its memory gone, or Wine loses its own server; both are
    said on the program's standard error. Such a command is run again in the folder as it was; seven times in a row are
    no accident (1 in 3e10).
    """
    before = {path: path.read_bytes() for path in folder.iterdir()}
    for _ in range(7):
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=600, stdin=subprocess.DEVNULL)
        if done.returncode != -signal.SIGKILL and not failed_itself(done):
            break
        for path in folder.iterdir():
            path.unlink()
        for path, data in before.items():
            path.write_bytes(data)
    return done


def failed_itself(done: subprocess.CompletedProcess[bytes]) -> bool:
    """Whether Wine failed, not the program: it lost its server, or a thread of a program that ended as it should.

    Without Wine's debugger, a program that crashes before its end has an exit status that `cg` never has (5 for memory
    that is not there).
    """
    lost_thread = done.returncode in (0, 1, 2) and b"wine: Unhandled" in done.stderr
    return lost_thread or b"wine client error:" in done.stderr


def content(path: Path) -> bytes:
    """The bytes of a file, decompressed."""
    return gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()


def first_difference(one: bytes, other: bytes) -> str:
    """The place where two texts begin to differ."""
    at = len(os.path.commonprefix((one, other)))
    begin = max(0, at - 60)
    return f"  here:  {one[begin : at + 60]!r}\n  there: {other[begin : at + 60]!r}"


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
    commands = {name: line for name, line in COMMANDS.items() if not (options.quick and name in LONG)}
    # The programs run in folders of their own.
    program = [*options.program[:-1], str(Path(options.program[-1]).resolve())]
    with tempfile.TemporaryDirectory() as here, tempfile.TemporaryDirectory() as there:
        ours = answers([str(options.reference.resolve())], Path(here), commands)
        theirs = answers(program, Path(there), commands)
    faults = [f"{name}: only {'here' if name in ours else 'there'}" for name in sorted(ours.keys() ^ theirs.keys())]
    faults += [
        f"{name} differs\n{first_difference(ours[name], theirs[name])}"
        for name in ours
        if name in theirs and ours[name] != theirs[name]
    ]
    faults += features_missing(program) if options.left_out else []
    if faults:
        sys.exit("\n".join(faults))
    size = sum(map(len, ours.values()))
    print(f"{len(ours)} answers and files of {size} bytes are equal to the last byte")


if __name__ == "__main__":
    main()
