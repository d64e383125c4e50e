"""What terms in Python add to a step of 64 environments, beside the same environments without them.

    python python/benchmarks/term_overhead.py [--rounds 7] [--limit 2]

Prints us of CPU time per environment and step, medians (quartiles) over rounds that take the contenders in turns. Exit
code 1 where a term costs more than `--limit` us.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable

import numpy as np

import crossgait
from crossgait import terms
from crossgait.envs import JointControlVectorEnv

COUNT = 64
CONFIG = crossgait.EnvironmentConfig(action="joints", robot="serial_quadruped", settle_seconds=0.1)


def forward(env: crossgait.Batch) -> np.ndarray:
    """The least that a term does."""
    return env.base_linear_velocity[:, 0]


REWARDS: dict[str, terms.RewardTerm] = {
    "one slice": terms.RewardTerm(forward),
    "feet_air_time": terms.RewardTerm(terms.feet_air_time),
    "foot_clearance": terms.RewardTerm(terms.foot_clearance, params={"height": 0.05}),
    "joint_pos_limits": terms.RewardTerm(terms.joint_pos_limits),
    "undesired_contacts": terms.RewardTerm(terms.undesired_contacts, params={"bodies": ["trunk"]}),
}


def seconds_of(work: Callable[[], object], times: int) -> float:
    """Least CPU time of one call among five series: what others on the machine take comes on top."""
    least = np.inf
    for _ in range(5):
        begin = time.process_time()
        for _ in range(times):
            work()
        least = min(least, (time.process_time() - begin) / times)
    return float(least)


def measure(rounds: int) -> dict[str, list[float]]:
    """Us per environment and step of what terms take, by contender; a term's is less that of none."""
    contenders = {"no term": terms.Terms()} | {
        name: terms.Terms(rewards={name: term}) for name, term in REWARDS.items()
    }
    found: dict[str, list[float]] = {name: [] for name in contenders}
    every = [JointControlVectorEnv(COUNT, CONFIG, terms=mine, workers=1) for mine in contenders.values()]
    actions = np.zeros((COUNT, 12))
    for envs in every:
        envs.reset(seed=0)
        envs.step(actions)
    for _ in range(rounds):
        base = 0.0
        for name, envs in zip(contenders, every, strict=True):
            running = envs.core._terms  # the same work as in a step, without the physics, whose time varies by more
            batch = envs.batch
            state = batch.qvel[:1].copy()

            def one_step(batch: crossgait.Batch = batch, state: np.ndarray = state, running: object = running) -> None:
                batch.set_state(qvel=state[0], indices=[0])  # arrays are gathered anew
                running.terminations()
                running.rewards()
                running.observe("policy")

            cost = seconds_of(one_step, 200) / COUNT * 1e6
            if name == "no term":
                base = cost
            found[name].append(cost if name == "no term" else cost - base)
    return found


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--limit", type=float, default=2.0, metavar="US")
    options = parser.parse_args()
    slow = []
    for name, costs in measure(options.rounds).items():
        low, median, high = np.percentile(costs, [25, 50, 75])
        print(f"{name:20} {median:6.2f} ({low:.2f} to {high:.2f})")
        if name != "no term" and median > options.limit:
            slow.append(name)
    if slow:
        print(f"more than {options.limit:g} us: {', '.join(slow)}", file=sys.stderr)
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
