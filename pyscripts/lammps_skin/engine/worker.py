"""One rank of a run on several: obeys the process that started it, through a socket.

Started by `lammps_skin.engine.ranks` as ``mpirun -np N python -m lammps_skin.engine.worker NAME``.
Each rank holds an `Engine`; a request is the name of one of its methods and arguments.
"""

from __future__ import annotations

import os
import select
import sys
import threading
from multiprocessing.connection import Client, Connection

from lammps_skin.engine.engine import Engine
from lammps_skin.errors import SkinError

KEY = "LAMMPS_SKIN_WORKER_KEY"


def main(name: str) -> None:
    with Client(f"\0{name}", "AF_UNIX", authkey=bytes.fromhex(os.environ[KEY])) as connection:
        rank = int(os.environ.get("PMI_RANK", os.environ.get("OMPI_COMM_WORLD_RANK", "0")))
        connection.send(rank)
        ended = threading.Event()
        threading.Thread(target=_end_with, args=(connection, ended), daemon=True).start()
        engine: Engine | None = None
        while not ended.is_set():
            method, arguments = connection.recv()
            try:
                if method == "open":
                    engine, result = Engine(*arguments), None
                else:
                    result = getattr(engine, method)(*arguments)
                succeeded = True
            except SkinError as error:
                succeeded, result = False, str(error)
            if method == "close":
                ended.set()
            connection.send((succeeded, result if rank == 0 or not succeeded else None))


def _end_with(connection: Connection, ended: threading.Event) -> None:
    """End this process, also in the middle of a step, when the one that it obeys has ended."""
    hung_up = select.poll()
    hung_up.register(connection.fileno(), select.POLLRDHUP)
    hung_up.poll()
    if not ended.is_set():
        os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1])
