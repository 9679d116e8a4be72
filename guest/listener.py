"""python-can's SocketCAN bus with `HeightListener`: prints the height after the drive."""

import signal
import sys
import time

import can
from cgheight import Vehicle
from cgheight.can import HeightListener

listener = HeightListener(Vehicle.load("/truck.toml"))
stop = []
signal.signal(signal.SIGTERM, lambda *_: stop.append(True))
with can.Bus("vcan1", interface="socketcan") as bus, can.Notifier(bus, [listener]):
    print("listening", file=sys.stderr, flush=True)
    while not stop:
        time.sleep(0.1)
estimate = listener.estimate()
print(estimate.status, estimate.height_m, listener.frames)
