"""The side of the engine in the protocol of physics/core/served_process.h and backends/served_memory.h."""

from __future__ import annotations

import json
import mmap
import os
import select
import socket
import struct
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from crossgait.serving.world import OPTIONAL, EngineState, ServableEngine, ServedWorld

PROTOCOL = 1  #: of the memory and the requests; Crossgait refuses another
VARIABLE = "CROSSGAIT_SERVES"
HEADER = struct.Struct("<QQQ")  # magic, protocol, bytes of text
MAGIC, TEXT_AT = 0x5652455347535243, 64
MESSAGE = struct.Struct("<II")  # number of the request; what is asked, or 0 of an answer and 1 of an error
STATE_SIZES = (3, 4, 3, 3)  # p_WB, q_WB, v_WB, w_WB


def serve_engine(
    engine: type[ServableEngine],
    *,
    library: str,
    laws: Mapping[str, str],
    version: str = "",
    mode: str = "",
    capabilities: Mapping[str, bool | str] | None = None,
    contact_margin: float | None = None,
    own_dynamics: bool = False,
) -> None:
    """Serve an engine to the program that began this one; the last line of the file that is the engine.

    Args:
        engine: makes a world of a `ServedWorld`: an object with `reset`, `step` and `state`, and any of `OPTIONAL`
        library: its name
        laws: `contact`, and any of `loops`, `joint_friction`, `joint_limits`, `couplings`, `contact_family`
        version: of the library; a stamp of the file is added to it
        mode: of its contacts, in words
        capabilities: what holds, as docs/adding-an-engine.md has it; `precision` "float64" or "float32"
        contact_margin: it takes `world.equations()` of every step, with points up to so far above the ground, m
        own_dynamics: it takes nothing but the points of them: its equations of motion are its own

    """
    places = os.environ.pop(VARIABLE, None)
    if places is None:
        name = os.path.basename(sys.argv[0])
        print(f"This is an engine. To ask it something: crossgait conformance --engine python:{name}", file=sys.stderr)
        sys.exit(2)
    said = {
        "protocol": PROTOCOL,
        "library": library,
        "version": version,
        "mode": mode,
        "laws": dict(laws),
        "capabilities": dict(capabilities or {}),
        "answers": [what for method, what in OPTIONAL.items() if hasattr(engine, method)],
        "equations": contact_margin is not None,
        "contact_margin": contact_margin or 0.0,
        "own_dynamics": own_dynamics,
    }
    _Server(places, engine, said).run()


class _Server:
    """The other end of physics/core/served_process.h and backends/served_memory.h."""

    def __init__(self, places: str, engine: type[ServableEngine], said: Mapping[str, Any]) -> None:
        there, memory, lifeline = (int(place) for place in places.split(":"))
        self._socket = socket.socket(fileno=there)
        self._memory = mmap.mmap(memory, os.fstat(memory).st_size)
        self._engine_type, self._said = engine, said
        magic, protocol, _ = HEADER.unpack_from(self._memory)
        if (magic, protocol) != (MAGIC, PROTOCOL):
            raise RuntimeError(f"this Python's crossgait has protocol {PROTOCOL}, the program that began it {protocol}")
        agreed = json.loads(self._text())
        numbers = np.frombuffer(self._memory, np.float64, offset=agreed["numbers_at"])
        self._blocks = {name: numbers[place : place + count] for name, (place, count) in agreed["blocks"].items()}
        self._engine: ServableEngine | None = None
        self._sizes = [*STATE_SIZES, 0, 0]
        # When the other process is gone, the system kills this one, as it told the system when it began this one. It
        # may have gone in between.
        if select.select([lifeline], [], [], 0)[0]:
            sys.exit(0)

    def _text(self) -> str:
        size = HEADER.unpack_from(self._memory)[2]
        return self._memory[TEXT_AT : TEXT_AT + size].decode()

    def _set_text(self, text: str) -> None:
        data = text.encode()
        self._memory[TEXT_AT : TEXT_AT + len(data)] = data
        HEADER.pack_into(self._memory, 0, MAGIC, PROTOCOL, len(data))

    def run(self) -> None:
        requests: Sequence[Callable[[], None]] = (
            *(self._hello, self._make, self._reset, self._step, self._save, self._restore, self._mass_matrix),
            *(self._body_pose, self._body_inertia, self._terrain_height, self._joint_friction, self._joint_limits),
        )
        while message := self._socket.recv(MESSAGE.size):
            number, what = MESSAGE.unpack(message)
            failed = 0
            try:
                requests[what - 1]()
            except Exception as error:  # whatever the engine raises is for its user
                place = traceback.extract_tb(error.__traceback__)[-1]
                where = f"{os.path.basename(place.filename)}, line {place.lineno}"
                self._set_text(f"{type(error).__name__}: {error} ({where})")
                failed = 1
            self._socket.send(MESSAGE.pack(number, failed))

    @property
    def _world(self) -> Any:
        if self._engine is None:
            raise RuntimeError("no world was made")
        return self._engine

    def _put(self, block: str, value: Any, size: int, what: str) -> None:
        array = np.asarray(value, np.float64).reshape(-1)
        if array.size != size:
            raise ValueError(f"{what}: expected {size} numbers, found {array.size}")
        self._blocks[block][:size] = array

    def _hello(self) -> None:
        self._set_text(json.dumps(self._said))

    def _make(self) -> None:
        told = json.loads(self._text())
        ground = told["terrain"]
        shape = (int(ground["rows"]), int(ground["columns"]))
        heights = self._blocks["heights"][: shape[0] * shape[1]].reshape(shape).copy()
        joints = len(told["robot"]["bodies"]) - 1
        self._sizes = [*STATE_SIZES, joints, joints]
        self._engine = None  # the one before goes first
        self._engine = self._engine_type(ServedWorld(told, heights, self._blocks))

    def _reset(self) -> None:
        ends = np.cumsum(self._sizes)
        asked = self._blocks["asked_state"][: ends[-1]].copy()
        self._world.reset(EngineState(*np.split(asked, ends[:-1])))
        self._put_state()

    def _put_state(self) -> None:
        place = 0
        parts = tuple(self._world.state())
        if len(parts) != len(EngineState._fields):
            raise ValueError(f"state: expected {', '.join(EngineState._fields)}, found {len(parts)} values")
        for name, part, size in zip(EngineState._fields, parts, self._sizes, strict=True):
            array = np.asarray(part, np.float64)
            if array.shape != (size,):
                raise ValueError(f"state: {name}: expected {size} numbers, found an array of shape {array.shape}")
            self._blocks["state"][place : place + size] = array
            place += size

    def _step(self) -> None:
        wrench = self._blocks["wrench"].copy()
        self._world.step(self._blocks["torques"][: self._sizes[-1]].copy(), wrench[:3], wrench[3:])
        self._put_state()
        if not hasattr(self._world, "contacts"):
            return
        contacts = list(self._world.contacts())
        rows = self._blocks["contacts"]
        most = rows.size // 13
        left_out = max(0, len(contacts) - most)
        if left_out:  # the shallowest, of equally deep ones the later
            deepest = sorted(range(len(contacts)), key=lambda i: (contacts[i].distance, i))[:most]
            contacts = [contacts[i] for i in sorted(deepest)]
        self._blocks["contact_counts"][0] = len(contacts)
        self._blocks["contact_counts"][1] += left_out  # to those that the equations left out
        for i, contact in enumerate(contacts):
            rows[13 * i : 13 * i + 13] = np.hstack([np.asarray(part, np.float64) for part in contact])

    def _save(self) -> None:
        saved = np.asarray(self._world.save(), np.float64).reshape(-1)
        if saved.size > self._blocks["saved"].size:
            raise ValueError(f"save: expected at most {self._blocks['saved'].size} numbers, found {saved.size}")
        self._put("saved", saved, saved.size, "save")
        self._blocks["argument"][0] = saved.size

    def _restore(self) -> None:
        self._world.restore(self._blocks["saved"][: int(self._blocks["argument"][0])].copy())
        self._put_state()

    def _mass_matrix(self) -> None:
        matrix = np.asarray(self._world.mass_matrix(), np.float64)
        self._put("answer", matrix, matrix.size, "mass_matrix")

    def _body_pose(self) -> None:
        p_WB, q_WB = self._world.body_pose(int(self._blocks["argument"][0]))
        self._put("answer", np.hstack((p_WB, q_WB)), 7, "body_pose")

    def _body_inertia(self) -> None:
        mass, p_BC, I_C = self._world.body_inertia(int(self._blocks["argument"][0]))
        self._put("answer", np.hstack((mass, p_BC, np.ravel(I_C))), 13, "body_inertia")

    def _terrain_height(self) -> None:
        x, y = self._blocks["argument"]
        self._put("answer", self._world.terrain_height(float(x), float(y)), 1, "terrain_height")

    def _joint_friction(self) -> None:
        self._put("answer", self._world.joint_friction(), self._sizes[-1], "joint_friction")

    def _joint_limits(self) -> None:
        self._put("answer", np.hstack(self._world.joint_limits()), 2 * self._sizes[-1], "joint_limits")
