"""One rank of a run on several: obeys the process that started it, through a socket.

Started by `lammps_skin.simulation` as ``mpirun -np N python -m lammps_skin.worker ADDRESS``.
Each rank holds an `Engine`; a request is the name of one of its methods and arguments.
"""

from __future__ import annotations

import os
import sys
from multiprocessing.connection import Client

from lammps_skin.engine import Engine
from lammps_skin.errors import SkinError

KEY = "LAMMPS_SKIN_WORKER_KEY"


def main(address: str) -> None:
    with Client(address, authkey=bytes.fromhex(os.environ[KEY])) as connection:
        rank = int(os.environ.get("PMI_RANK", os.environ.get("OMPI_COMM_WORLD_RANK", "0")))
        connection.send(rank)
        engine: Engine | None = None
        while True:
            try:
                method, arguments = connection.recv()
            except EOFError:
                break
            try:
                if method == "open":
                    engine, result = Engine(*arguments), None
                else:
                    result = getattr(engine, method)(*arguments)
                connection.send((True, result if rank == 0 else None))
            except SkinError as error:
                connection.send((False, str(error)))
            if method == "close":
                break


if __name__ == "__main__":
    main(sys.argv[1])
