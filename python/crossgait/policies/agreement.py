"""Whether a bundle computes what the model that it was made of does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from crossgait._core import MlpNetwork, PolicyBundle, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.layout import Layout

FloatArray = npt.NDArray[np.float64]

#: Sums of a thousand products of order one are good to about 1e-6 in single precision, in whatever order they are
#: added; a wrong activation, normalisation or layer order is off by far more than 1e-5, which in turn moves a foot by
#: no more than .1 micrometres. Of actions within their bounds. It is also what loading a bundle asks for.
TOLERANCE = 1e-5
#: Where the model itself computes in half precision: 5e-4 per rounding, and a handful of them in a row.
HALF_TOLERANCE = 1e-2
#: What a bundle holds at most.
MAX_PAIRS = 256


def spread(bundle: PolicyBundle) -> FloatArray:
    """Raw observations [24, obs] for golden pairs: the bundle's own, some beyond its clip, and nearer to the mean.

    Near the mean the actions are within their bounds, where they tell more of the network. All are single precision,
    so that every runtime sees the same.
    """
    own = bundle.golden_observation
    normalisation = bundle.network.normalisation
    mean = normalisation[0] if normalisation else np.zeros(own.shape[1])
    scaled = [mean + scale * (own - mean) for scale in (1.0, 0.25, 0.05)]
    return np.concatenate(scaled).astype(np.float32).astype(np.float64)


def checked_observations(observations: npt.ArrayLike, layout: Layout) -> FloatArray:
    """Raw observations [n, obs] that a caller gives, in single precision. Raises ConfigError."""
    array = np.asarray(observations, dtype=np.float32).astype(np.float64)
    if array.ndim != 2 or not len(array) or array.shape[1] != len(layout):
        raise ConfigError("observations", "shape", f"[n, {len(layout)}]", f"{list(array.shape)}")
    if not np.isfinite(array).all():
        raise ConfigError("observations", "numbers", "finite ones", "others")
    return array


def check_agreement(
    ours: FloatArray, theirs: FloatArray, action: Layout, source: str, runtime: str, tolerance: float = TOLERANCE
) -> None:
    """Raise ConfigError with the largest difference unless `ours` and `theirs`, actions [n, act], are the same.

    Compared is what is acted: within the bounds of the action.
    """
    if theirs.shape != ours.shape or not np.isfinite(theirs).all():
        found = "others" if theirs.shape == ours.shape else f"shape {list(theirs.shape)}"
        raise ConfigError(source, f"actions of {runtime}", f"{list(ours.shape)} finite numbers", found)
    ours, theirs = (np.clip(actions, action.low, action.high) for actions in (ours, theirs))
    difference = np.abs(ours - theirs)
    if (difference <= tolerance).all():
        return
    row, i = np.unravel_index(np.argmax(difference), difference.shape)
    raise ConfigError(
        source,
        f"action {action.names[i]} of golden pair {row}",
        f"what {runtime} computes, {theirs[row, i]:.7g} within {tolerance:g}",
        f"{ours[row, i]:.7g}: the largest difference is {difference[row, i]:.3g}",
    )


def agreed_bundle(
    network: MlpNetwork,
    interface: PolicyInterface,
    run: Callable[[FloatArray], FloatArray],
    source: str,
    runtime: str,
    *,
    half: bool = False,
    observations: npt.ArrayLike | None = None,
) -> PolicyBundle:
    """A bundle whose golden actions are those of the model itself.

    Args:
        network: read from the model
        interface: what it was trained for
        run: the model in its own runtime: actions [n, act] of raw observations [n, obs]
        source: the model's file or name, for messages
        runtime: its name, for messages
        half: whether the model computes in half precision; golden actions are then the network's own
        observations: raw ones [n, obs], best of a run; its own choice otherwise

    """
    bundle = PolicyBundle(network, interface, source)
    action = Layout.of(interface.action_layout)
    if observations is None:
        given = spread(bundle)
    else:
        given = checked_observations(observations, Layout.of(interface.observation_layout))
    ours, theirs = bundle.network.evaluate(given), run(given)
    check_agreement(ours, theirs, action, source, runtime, HALF_TOLERANCE if half else TOLERANCE)
    rows = np.unique(np.linspace(0, len(given) - 1, MAX_PAIRS).astype(int))
    golden = np.clip(ours if half else theirs, action.low, action.high)
    return bundle.with_golden_pairs(given[rows], golden[rows], source)
