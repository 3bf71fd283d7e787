"""What all tests need of the process that they run in."""

import os
import signal

# a shell starts what it runs in the background with interrupts ignored, and so would our processes
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# ranks that wait sleep instead of spinning: tests on two ranks share the cores with other tests
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE", "1")
