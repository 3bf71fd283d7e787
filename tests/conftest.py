"""What all tests need of the process that they run in."""

import signal

# a shell starts what it runs in the background with interrupts ignored, and so would our processes
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
