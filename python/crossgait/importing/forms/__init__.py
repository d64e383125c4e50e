"""The forms in which interfaces of policies are published: what each says, in the fields of a contract."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from crossgait.errors import ConfigError
from crossgait.importing.contract import Contract
from crossgait.importing.forms import deploy, isaac_lab, legged_gym, mjlab, rl_sar
from crossgait.importing.forms.shared import Options
from crossgait.importing.stated import Stated

__all__ = ["Form", "Options", "find_form"]


@dataclass(frozen=True)
class Form:
    """A kind of file, known by keys that it has to have."""

    name: str
    keys: tuple[str, ...]
    read: Callable[[Stated, Contract, Options], None]


FORMS = (
    Form("deploy.yaml of unitree_rl_lab", ("joint_ids_map", "step_dt", "actions", "observations"), deploy.read),
    Form("ONNX metadata of mjlab", ("joint_names", "observation_names"), mjlab.read),
    Form("env.yaml of Isaac Lab", ("sim", "decimation", "scene", "actions", "observations"), isaac_lab.read),
    Form("configuration class of legged_gym", ("control",), legged_gym.read),
)
#: One mapping under a name; known by any of these below it.
RL_SAR = Form("base.yaml or config.yaml of rl_sar", ("num_of_dofs", "rl_kp", "observations"), rl_sar.read)


def find_form(root: Stated) -> Form:
    """The form of a file's contents. Raises ConfigError listing the forms."""
    if isinstance(root.raw, dict):
        for form in FORMS:
            if all(key in root.raw for key in form.keys):
                return form
        only = next(iter(root.raw.values())) if len(root.raw) == 1 else None
        if only is not None and isinstance(only.raw, dict) and any(key in only.raw for key in RL_SAR.keys):
            return RL_SAR
    known = "; ".join(f"{form.name} ({', '.join(form.keys)})" for form in (*FORMS, RL_SAR))
    raise ConfigError(root.source, "file", f"keys of one of these forms: {known}", "others")
