"""Delay of `cg run` with and without clients of its live page.

    CG=target/release/cg python benches/python/live_clients.py    # CG_BENCH_SECONDS=4: short

Prints a section for benches/RESULTS.md. One program gets a row every 5 ms and writes a status for
each. The delay is the time from a row to its status. Blocks of two seconds without clients and with
ten (five of them never read) alternate in the same run, so that other work on the machine affects
both alike.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import threading
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
CG = os.environ.get("CG", str(ROOT / "target" / "release" / "cg"))
SECONDS = float(os.environ.get("CG_BENCH_SECONDS", "120"))
BLOCK_S, STEP_S = 2.0, 0.005
SETTLE_S = 0.3  # after each change of the clients
REQUEST = b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"
ROW = "{:.3f},0.0,0.0,13.9,0.0,18684\n"


class Clients:
    """Ten clients; five of them never read."""

    def __init__(self, port: int) -> None:
        """Connect them."""
        self.sockets = []
        self.bytes = 0
        for k in range(10):
            client = socket.socket()
            if k >= 5:  # a small buffer is soon full
                client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
            client.connect(("127.0.0.1", port))
            client.sendall(REQUEST)
            self.sockets.append(client)
        self.readers = [threading.Thread(target=self.read, args=(s,)) for s in self.sockets[:5]]
        for reader in self.readers:
            reader.start()

    def read(self, client: socket.socket) -> None:
        """Read until the end."""
        while data := client.recv(65536):
            self.bytes += len(data)

    def close(self) -> None:
        """Disconnect all of them."""
        for client in self.sockets:
            client.shutdown(socket.SHUT_RDWR)
        for reader in self.readers:
            reader.join()
        for client in self.sockets:
            client.close()


def main() -> None:
    """Print the percentiles of the delay and their ratios."""
    truck = ROOT / "fixtures" / "vehicles" / "kraz.toml"
    command = [CG, "run", "--vehicle", truck, "--csv", "-", "--serve", "0", "--status-s", "0.001"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
    program = subprocess.Popen(command, **pipes)
    lines = program.stdout
    header = "time_s,steer_rad,roll_rad,speed_mps,lateral_acceleration_mps2,trailer_mass_kg\n"
    program.stdin.write(header)
    page = json.loads(lines.readline())["page"]
    port = int(page.rstrip("/").rsplit(":", 1)[1])
    arrived: dict[float, float] = {}

    def read() -> None:
        for text in lines:
            now = time.perf_counter()
            line = json.loads(text)
            if line["event"] == "status":
                arrived.setdefault(round(line["time_s"], 3), now)

    reader = threading.Thread(target=read)
    reader.start()
    sent: dict[bool, dict[float, float]] = {False: {}, True: {}}
    row, taken = 0, 0
    for block in range(max(2, round(SECONDS / BLOCK_S))):
        clients = Clients(port) if block % 2 else None
        began = time.perf_counter()
        while (now := time.perf_counter()) < began + BLOCK_S:
            row += 1
            stamp_s = round(row * STEP_S, 3)
            if now > began + SETTLE_S:
                sent[clients is not None][stamp_s] = now
            program.stdin.write(ROW.format(stamp_s))
            time.sleep(STEP_S)
        if clients:
            taken += clients.bytes
            clients.close()
    program.stdin.close()
    program.wait()
    reader.join()
    assert taken > 0, "no client has read anything"
    report(sent, arrived)


def report(sent: dict[bool, dict[float, float]], arrived: dict[float, float]) -> None:
    """Print the table."""
    found = {}
    for clients, rows in sent.items():
        delays = [arrived[stamp_s] - began for stamp_s, began in rows.items() if stamp_s in arrived]
        # The stop repeats the last status; every other row has one of its own.
        assert len(delays) >= len(rows) - 1, "a row has no status"
        found[clients] = 1e3 * np.array(delays)
    print("## Live page\n")
    print(
        "Delay from a row on standard input of `cg run --serve` to its status, 5 ms between rows;"
    )
    print("blocks without clients and with ten, five of which never read, alternate in one run.\n")
    print("| clients | rows | median | 99th percentile |\n|---|---|---|---|")
    for clients, delays in found.items():
        median, p99 = np.percentile(delays, [50, 99])
        print(f"| {10 if clients else 0} | {len(delays)} | {median:.3f} ms | {p99:.3f} ms |")
    ratios = [np.percentile(found[True], p) / np.percentile(found[False], p) for p in (50, 99)]
    print(f"| ratio | | {ratios[0]:.2f} | {ratios[1]:.2f} |\n")


if __name__ == "__main__":
    main()
