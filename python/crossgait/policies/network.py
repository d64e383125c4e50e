"""From an expression to the network that a bundle holds."""

from __future__ import annotations

import math

import numpy as np

from crossgait._core import MlpNetwork
from crossgait.layout import Layout
from crossgait.policies.expression import Activated, Affine, Observation
from crossgait.policies.place import Place

#: Of bundles (docs/policies.md).
ACTIVATIONS = ("tanh", "elu", "relu", "swish")
#: Of limits that a model states in single precision.
_ROUNDING = 1e-6
_HIDDEN = f"{', '.join(ACTIVATIONS)} after every layer but the last"


def check_width(found: int, layout: Layout, what: str, place: Place) -> None:
    """Raise ConfigError naming the first entry of the layout that is without a number, or the last that has one."""
    if found < len(layout):
        place.fail(f"{len(layout)} {what}s", f"{found}, none of which is {layout.names[found]}")
    if found > len(layout):
        place.fail(f"{len(layout)} {what}s", f"{found}, the last {found - len(layout)} after {layout.names[-1]}")


def to_network(value: Affine, action: Layout, place: Place) -> MlpNetwork:
    """The network that gives `value`, an action. Raises ConfigError where bundles cannot say it."""
    check_width(len(value), action, "action", place)
    value = _within_limits(value, action)
    output = "linear"
    if isinstance(value.base, Activated) and value.base.function == "tanh" and value.is_identity():
        output, value = "tanh", value.base.of
    layers, activations = [(value.weight, value.bias)], list[Activated]()
    base = value.base
    while isinstance(base, Activated):
        if base.function not in ACTIVATIONS:
            base.place.fail(_HIDDEN, base.function)
        if activations and base.function != activations[-1].function:
            base.place.fail("the same activation everywhere", f"{base.function} and {activations[-1].function}")
        activations.append(base)
        layers.append((base.of.weight, base.of.bias))
        base = base.of.base
    return MlpNetwork(
        layers[::-1],
        activation=activations[0].function if activations else "tanh",
        output=output,
        normalisation=_normalisation(base, place),
        clip=None if math.isinf(base.clip) else base.clip,
    )


def _within_limits(value: Affine, action: Layout) -> Affine:
    """Without limits that no action reaches, as they are clipped to the layout's."""
    base = value.base
    if not (isinstance(base, Activated) and base.limits and value.is_identity()):
        return value
    low, high = base.limits
    allowed = _ROUNDING * np.abs([action.low, action.high])
    for i in np.flatnonzero((low > action.low + allowed[0]) | (high < action.high - allowed[1])):
        base.place.fail(
            f"limits as wide as those of {action.names[i]}, {action.low[i]:g} to {action.high[i]:g}",
            f"{low[i]:g} to {high[i]:g}",
        )
    return _within_limits(base.of, action)


def _normalisation(base: Observation, place: Place) -> tuple[np.ndarray, np.ndarray] | None:
    if not base.mean.any() and (base.std == 1).all():
        return None
    if not (np.isfinite(base.mean).all() and np.isfinite(base.std).all() and (base.std > 0).all()):
        place.fail("a finite mean and a standard deviation above zero", "others")
    return base.mean, base.std
