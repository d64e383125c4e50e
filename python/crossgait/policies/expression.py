"""What the numbers of a network are, whichever way an exporter spells it.

Every tensor of a multilayer perceptron is an affine map of one of two things: of the observation, normalised and
clipped, or of what an activation gives. `Affine` says so, and the functions below do to it what the operations of
ONNX and PyTorch do. Two spellings of one network lead to the same expression; what no bundle holds is refused at
the node or layer that asks for it.

Arrays are float64. A `value` has n numbers; constants are single numbers or have n as well.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from crossgait.policies.place import Place

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Observation:
    """clip((x - mean) / std, -clip, clip), entry by entry; std > 0."""

    mean: FloatArray
    std: FloatArray
    clip: float = math.inf


@dataclass(frozen=True, eq=False)
class Activated:
    """A function of every number of `of`, or its limits."""

    function: str
    of: Affine
    place: Place
    limits: tuple[FloatArray, FloatArray] | None = None


@dataclass(frozen=True, eq=False)
class Affine:
    """weight @ base + bias, with weight [n, numbers of the base]."""

    base: Observation | Activated
    weight: FloatArray
    bias: FloatArray

    def __len__(self) -> int:
        return len(self.bias)

    def is_identity(self) -> bool:
        """Whether it is just its base."""
        rows, columns = self.weight.shape
        return rows == columns and not self.bias.any() and np.array_equal(self.weight, np.eye(rows))


def same(a: Affine, b: Affine) -> bool:
    """Whether both are the same map of the same thing."""
    return a.base is b.base and np.array_equal(a.weight, b.weight) and np.array_equal(a.bias, b.bias)


def identity_of(base: Observation | Activated, size: int) -> Affine:
    """All numbers of `base` as they are."""
    return Affine(base, np.eye(size), np.zeros(size))


def observation(mean: FloatArray, std: FloatArray, clip: float = math.inf) -> Affine:
    """The observation, normalised."""
    return identity_of(Observation(mean, std, clip), len(mean))


def constant(numbers: npt.ArrayLike, place: Place) -> FloatArray:
    """A constant of the model, as float64. Raises ConfigError unless it is finite."""
    array = np.asarray(numbers, dtype=np.float64)
    if not np.isfinite(array).all():
        at = np.argwhere(~np.isfinite(array))[0].tolist()
        place.fail("finite numbers", f"{array[tuple(at)]} at {at}")
    return array


def _along(value: Affine, numbers: npt.ArrayLike, place: Place) -> FloatArray:
    """A constant as one number for each of `value`."""
    array = constant(numbers, place)
    if array.size not in (1, len(value)) or (array.ndim > 1 and array.shape[-1] != array.size):
        place.fail(f"a number, or {len(value)} of them", f"a constant of shape {list(array.shape)}")
    return np.broadcast_to(array.reshape(-1), (len(value),)).copy()


def _normalises(value: Affine) -> Observation | None:
    """What operations with constants add to: the observation before any clip."""
    base = value.base
    if isinstance(base, Observation) and math.isinf(base.clip) and value.is_identity():
        return base
    return None


def add(value: Affine, numbers: npt.ArrayLike, place: Place) -> Affine:
    """Value + numbers: a constant for each."""
    along = _along(value, numbers, place)
    if not along.any():
        return value
    if normalised := _normalises(value):
        mean = normalised.mean - along * normalised.std
        return identity_of(replace(normalised, mean=mean), len(value))
    return Affine(value.base, value.weight, value.bias + along)


def multiply(value: Affine, numbers: npt.ArrayLike, place: Place) -> Affine:
    """Value * numbers."""
    along = _along(value, numbers, place)
    if (along == 1).all():
        return value
    if (normalised := _normalises(value)) and (along > 0).all():
        return identity_of(replace(normalised, std=normalised.std / along), len(value))
    return Affine(value.base, value.weight * along[:, None], value.bias * along)


def divide(value: Affine, numbers: npt.ArrayLike, place: Place) -> Affine:
    """Value / numbers: of its own, so that a divisor is kept to the last bit where it is a standard deviation."""
    along = _along(value, numbers, place)
    if not along.all():
        place.fail("divisors other than zero", f"0 at {int(np.argmin(along != 0))}")
    if (normalised := _normalises(value)) and (along > 0).all():
        return identity_of(replace(normalised, std=normalised.std * along), len(value))
    return Affine(value.base, value.weight / along[:, None], value.bias / along)


def linear(value: Affine, weight: npt.ArrayLike, bias: npt.ArrayLike | None, place: Place) -> Affine:
    """Weight @ value + bias; weight is [outputs, inputs]."""
    matrix = constant(weight, place)
    if matrix.ndim != 2 or matrix.shape[1] != len(value):
        place.fail(f"weights for {len(value)} inputs", f"shape {list(matrix.shape)} [outputs, inputs]")
    if value.is_identity():
        result = Affine(value.base, matrix, np.zeros(len(matrix)))
    else:
        result = Affine(value.base, matrix @ value.weight, matrix @ value.bias)
    if bias is None:
        return result
    return replace(result, bias=result.bias + _along(result, bias, place))


def combine(a: Affine, b: Affine, sign: float, place: Place) -> Affine:
    """A + sign * b, which have to be maps of the same thing."""
    if a.base is not b.base or len(a) != len(b):
        place.fail("layers one after the other", "a sum of different layers, as of a skip connection")
    return Affine(a.base, a.weight + sign * b.weight, a.bias + sign * b.bias)


def product(a: Affine, b: Affine, place: Place) -> Affine:
    """A * b, which is swish if one is the sigmoid of the other."""
    for x, sigmoid in ((a, b), (b, a)):
        gate = sigmoid.base
        if not (isinstance(gate, Activated) and gate.function == "sigmoid" and sigmoid.is_identity()):
            continue
        if same(gate.of, x):
            return activate("swish", x, place)
    place.fail("x times sigmoid(x), which is swish", "a product of two other values")


def take(value: Affine, indices: Sequence[int] | npt.NDArray[np.int64], place: Place) -> Affine:
    """Some of the numbers, in this order."""
    chosen = np.asarray(indices, dtype=np.int64)
    if chosen.ndim != 1 or not len(chosen) or not ((chosen >= -len(value)) & (chosen < len(value))).all():
        place.fail(f"some of {len(value)} numbers", f"the indices {chosen.tolist()}")
    if np.array_equal(chosen, np.arange(len(value))):
        return value
    return Affine(value.base, value.weight[chosen], value.bias[chosen])


def concatenate(values: Sequence[Affine], place: Place) -> Affine:
    """One after the other; all of them maps of the same thing."""
    if any(value.base is not values[0].base for value in values):
        place.fail("parts of one layer", "different layers side by side")
    if len(values) == 1:
        return values[0]
    return Affine(values[0].base, np.vstack([v.weight for v in values]), np.concatenate([v.bias for v in values]))


def activate(function: str, value: Affine, place: Place) -> Affine:
    """`function` of every number: tanh, elu, relu, swish; sigmoid as part of swish."""
    return identity_of(Activated(function, value, place), len(value))


def clip(value: Affine, low: npt.ArrayLike, high: npt.ArrayLike, place: Place) -> Affine:
    """Limits of every number: the clip of a normalised observation, ReLU (0 and nothing), or those of the action."""
    limits = []
    for numbers in (low, high):
        array = np.asarray(numbers, dtype=np.float64).reshape(-1)
        if array.size not in (1, len(value)) or np.isnan(array).any():
            place.fail(f"limits, one or {len(value)}", f"{array.tolist()}")
        limits.append(np.broadcast_to(array, (len(value),)))
    lowest, highest = limits
    if (lowest > highest).any():
        place.fail("a lower limit below the upper", f"{lowest.tolist()} and {highest.tolist()}")
    if (np.isneginf(lowest) & np.isposinf(highest)).all():
        return value
    if not lowest.any() and np.isposinf(highest).all():
        return activate("relu", value, place)
    if isinstance(value.base, Observation) and value.is_identity():
        if (highest != highest[0]).any() or (lowest != -highest).any() or not highest[0] > 0:
            place.fail(
                "one limit of the normalised observation, the same up and down",
                f"{lowest.tolist()} and {highest.tolist()}",
            )
        base = replace(value.base, clip=min(value.base.clip, float(highest[0])))
        return identity_of(base, len(value))
    return identity_of(Activated("clip", value, place, (lowest, highest)), len(value))
