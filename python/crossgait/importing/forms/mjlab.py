"""Metadata that mjlab writes into ONNX files."""

from __future__ import annotations

from typing import Any

import numpy as np

from crossgait.importing import terms
from crossgait.importing.contract import Contract
from crossgait.importing.forms.shared import Options, say_isaac_history
from crossgait.importing.stated import Stated


def read(root: Stated, contract: Contract, options: Options) -> None:
    """Metadata that mjlab writes into ONNX files (get_base_metadata)."""
    for key in ("run_path", "command_names"):
        if (value := root.find(key)) is not None:
            value.skip()
    contract.say_named_order(_listed(root.at("joint_names")))
    for key, name in (
        ("joint_stiffness", "servos.kp"),
        ("joint_damping", "servos.kd"),
        ("default_joint_pos", "joints.home"),
        ("action_scale", "joints.scale"),
    ):
        contract.say_by_joint(name, root.find(key))
    # The metadata do not name the integrator.
    contract.assume(
        "servos.implicit_damping", dict.fromkeys(contract.joints, 1.0), "mjlab's default integrator, implicitfast"
    )
    names = _listed(root.at("observation_names"))
    if contract.is_set("observation"):
        root.skip()
        return
    count = len(names.items())
    scales, clips, histories = (
        _listed(root.find(f"observation_terms_{key}"), count) for key in ("scale", "clip", "history_length")
    )
    if (flat := root.find("observation_terms_flatten_history_dim")) is not None:
        flat.skip()
    said = []
    for i, item in enumerate(names.items()):
        block = terms.block_of(item.text(), terms.MJLAB, item)
        history = max(int(histories[i].number()), 1) if histories is not None else 1
        clip = _clip(clips[i]) if clips is not None else None
        scale = scales[i].number() if scales is not None else 1.0
        one = terms.term(contract, block, scale, None, history)
        if clip is not None:
            one["clip_unscaled"] = clip
        said.append((one, item.place))
    terms.say_terms(contract, said, names)
    say_isaac_history(contract, names)


def _listed(value: Stated | None, count: int | None = None) -> Any:
    """A list, also of one element, which metadata writes as the element."""
    if value is None:
        return None
    if not isinstance(value.raw, list):
        value = Stated([Stated(value.raw, value.source, value.line, value.path)], value.source, value.line, value.path)
    if count is None:
        return value
    if len(value.items()) != count:
        value.fail(f"{count} elements, one for each of observation_names", f"{len(value.items())}")
    return value.items()


def _clip(value: Stated) -> float | None:
    """The limit of "-100;100"; None for "-inf;inf"."""
    low, _, high = value.text().partition(";")
    try:
        limits = float(low), float(high)
    except ValueError:
        value.fail("LOW;HIGH")
    if limits[0] != -limits[1] or not limits[1] > 0:
        value.fail("limits of the same size, -X;X")
    return None if np.isinf(limits[1]) else limits[1]
