"""python-can's SocketCAN bus with `HeightListener`: prints the height after the drive, when no frame has come for a while.

The processor is emulated, beside other work of the host, so Python may be slower than the bus: it reads from its queue until
that is empty. Its time stamps are those of the kernel.
"""

import sys
import time

import can
from cgheight import Vehicle
from cgheight.can import HeightListener

# The drive begins within a minute of the words below, and has hundreds of frames a second.
BEGINS_S, PAUSE_S = 60, 5

listener = HeightListener(Vehicle.load("/truck.toml"))
with can.Bus("vcan1", interface="socketcan") as bus, can.Notifier(bus, [listener]):
    print("listening", file=sys.stderr, flush=True)
    frames, since = 0, time.monotonic()
    while time.monotonic() - since < (PAUSE_S if frames else BEGINS_S):
        time.sleep(0.2)
        if listener.frames != frames:
            frames, since = listener.frames, time.monotonic()
estimate = listener.estimate()
print(estimate.status, estimate.height_m, listener.frames)
