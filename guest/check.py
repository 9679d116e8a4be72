"""Prints the verdicts of the guest test, one per line; exit status 1 if a check fails."""

import json
import sys
from pathlib import Path

work = Path(sys.argv[1])
results = work / "results"
bad = 0


def verdict(name: str, good: bool, said: str) -> None:
    global bad
    bad += not good
    print(f"guest: {'pass' if good else 'FAIL'}: {name}: {said}")


def lines(path: Path, event: str | None = None) -> list[dict]:
    found = [json.loads(line) for line in path.read_text().splitlines() if line.startswith("{")]
    return [line for line in found if event in (None, line["event"])]


live = results / "live.jsonl"
expected = lines(work / "csv.jsonl", "maneuver")
# The last maneuver of the CSV ends with the file, that of the live run with the next straight section.
heights = [line["height_m"] for line in lines(live, "maneuver") if line["height_m"]]
reference = expected[-1]["height_m"]
error = abs(heights[-1] / reference - 1) if heights else float("inf")
# Time stamps are those of reception: 2 ms of jitter at a roll rate of about 0.02 rad/s give 4e-5 rad
# of 0.1, in thousands of samples. Half a percent is ten times the noise that this adds.
verdict(
    "a drive through vcan gives the height of its CSV",
    error < 5e-3,
    f"{heights[-1] if heights else None} m, CSV {reference} m",
)

before, after, began, ended = map(float, (results / "load.txt").read_text().split())
settings = dict(line.split("=") for line in (work / "root" / "settings").read_text().split())
sent = int(settings["rate"]) * int(settings["seconds"])
status = lines(live, "status")
end_of_load = [line for line in status if line["frames"] >= sent]
rate = (after - before) / (ended - began)
# The senders are emulated too, and a busy machine slows them down. Below half of the requested rate
# the test would prove nothing.
verdict(
    "bus load",
    after - before >= sent and rate >= 0.5 * int(settings["rate"]),
    f"{after - before:.0f} frames in {ended - began:.1f} s: {rate:.0f} frames/s, "
    f"{settings['rate']} asked for",
)
verdict(
    "no frame lost",
    bool(end_of_load) and all(line["frames_lost"] == 0 for line in status),
    f"{status[-1]['frames']} frames taken in, {status[-1]['frames_lost']} lost, "
    f"{status[-1]['values_of_other_sources']} values of other devices passed over",
)

metrics = dict(
    line.split() for line in (results / "metrics.prom").read_text().splitlines() if line[0] != "#"
)
p50, p99 = (1e3 * float(metrics[f"cg_latency_{p}_seconds"]) for p in ("p50", "p99"))
# The target is a p99 of 10 ms on a dedicated machine. Here the processor is emulated, and other work
# of the host stops it for a while; the median is not affected by that.
verdict("latency of a frame (emulated CPU)", p50 < 10, f"p50 {p50:.2f} ms, p99 {p99:.2f} ms")

frames = [line.split()[2].split("#")[1] for line in (results / "sent.log").read_text().splitlines()]
data = [bytes.fromhex(frame) for frame in frames]
known = [int.from_bytes(d[:2], "little") * 1e-3 for d in data if d[6] in (1, 2)]
verdict(
    "transmission read back",
    bool(known) and any(abs(known[-1] - height) < 1e-3 for height in heights),
    f"{len(data)} frames, {len(known)} with a height, the last {known[-1] if known else None} m",
)

# Each change is reported once, whether the reading or the writing side noticed it first.
downs = int(settings["downs"])
notices = [line["message"] for line in lines(live, "notice") if "vcan0: " in line["message"]]
should = ["vcan0: Network is down (os error 100); waiting for it", "vcan0: up again"] * downs
verdict(
    f"interface down and up, {downs} times",
    notices == should,
    f"reported {sum('waiting' in text for text in notices)} and {sum('up' in text for text in notices)} times",
)

notices = [line["message"] for line in lines(live, "notice") if line["subject"] == "metrics"]
verdict(
    "disk full, then read-only",
    [text.removeprefix("cannot be written, will be tried again: ") for text in notices]
    == ["No space left on device (os error 28)", "can be written again",
        "Read-only file system (os error 30)", "can be written again"],
    "; ".join(notices),
)  # fmt: skip

resumed = results / "resumed.jsonl"
start = lines(resumed, "start")[0]
first = lines(resumed, "status")[0]
kept = json.loads((results / "state.json").read_text().splitlines()[0])
last = [line["height_m"] for line in lines(live, "status")][-1]
verdict(
    "killed and resumed",
    start["restored"] and first["height_m"] == last,
    f"height {first['height_m']} m after, {last} m before; state of {kept['saved_s']:.0f} s",
)

notices = [line["message"] for line in lines(resumed, "notice")]
stop = lines(resumed, "stop")
verdict(
    "interface removed and created again; SIGTERM",
    any("waiting for it" in text for text in notices)
    and bool(stop)
    and stop[0]["reason"] == "signal"
    and (results / "exit.txt").read_text().strip() == "0",
    "; ".join(notices),
)
told = (results / "listener.txt").read_text().split() or ["nothing", "nan", "0"]
frames = len((work / "drive.log").read_text().splitlines())
# The same tolerance as for `cg run`: python-can also uses the kernel's time stamps.
verdict(
    "python-can's SocketCAN bus with HeightListener",
    told[0] == "ok" and abs(float(told[1]) / reference - 1) < 5e-3 and int(told[2]) == frames,
    f"{told[1]} m from {told[2]} of {frames} frames"
    + ("" if told[0] == "ok" else (results / "listener.err").read_text()[-500:]),
)

# The same frames, with the tolerance of the first drive.
played, by_file = (lines(path, "maneuver") for path in (results / "tractor.jsonl", work / "tractor.jsonl"))
height_m = played[-1]["height_m"] if played else None
wanted_m = by_file[-1]["height_m"]
verdict(
    "a height from the tractor's levels and specific force alone, on a banked road",
    bool(height_m) and abs(height_m / wanted_m - 1) < 5e-3 and played[-1]["channel"] == "tractor",
    f"{height_m} m, from the file {wanted_m} m",
)

for name in ("live.err", "resumed.err", "tractor.err"):
    text = (results / name).read_text().strip()
    verdict(f"nothing on standard error ({name})", not text, text or "empty")
sys.exit(bad > 0)
