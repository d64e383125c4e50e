"""The three stages of a hierarchical policy: the planner alone, residuals under the frozen planner, both together."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

import crossgait
from crossgait._core import LAYOUT_VERSION, PolicyBundle, PolicyInterface
from crossgait.files import written_whole
from crossgait.policies.policy import bundle_of, bytes_of
from crossgait.sweep.strict_yaml import read_yaml, write_yaml
from crossgait.train import checkpoint, ppo
from crossgait.train.folder import BEST
from crossgait.train.keys import PLANNER, RESIDUAL
from crossgait.train.learner import Learner, seen
from crossgait.train.members import Member, MemberEnvs, TwoPaceEnvs
from crossgait.train.plan import Plan
from crossgait.train.ppo import TimedPPO
from crossgait.train.remote_envs import Workers
from crossgait.train.trainer import Trained, Trainer
from crossgait.train.two_pace_policy import Normalised, Start, TwoPacePolicy, linear_layers

Json = dict[str, Any]


@dataclass(frozen=True)
class Hierarchy:
    """Both members, and how many policy steps a plan lasts."""

    planner: Member
    residual: Member
    period: int
    plan: Plan  #: that says so

    @staticmethod
    def of(plan: Plan) -> Hierarchy:
        """As a plan with `hierarchy` says it."""
        said, environment = plan["hierarchy"], plan.stages[0].environment
        whole, fine = PolicyInterface(environment), environment.policy_dt
        period = round(said["planner_dt"] / fine)
        planner = Member.of(whole, PLANNER, said["planner"]["observation"], said["planner_dt"])
        return Hierarchy(planner, Member.of(whole, RESIDUAL, said["residual"]["observation"], fine), period, plan)

    def __reduce__(self) -> tuple[Any, ...]:
        return Hierarchy.of, (self.plan,)

    def write(
        self, folder: Path, name: str, steps: int, planner: crossgait.Policy, residual: crossgait.Policy | None
    ) -> Path:
        """Write `name`.yaml, a description, and its bundles, whose names tell the steps; returns the description.

        The residuals are zero if there are none. The description is written last, and bundles that none in the folder
        names any more are taken away then: what it names is there at any moment.
        """
        file = folder / f"{name}.yaml"
        said: Json = {"kind": "hierarchical", "layout_version": LAYOUT_VERSION}
        for part, member, policy in (("planner", self.planner, planner), ("residual", self.residual, residual)):
            said[part] = {"policy": "zero" if policy is None else f"{part}-{steps}.safetensors"}
            if member.sees:
                said[part]["observation"] = list(member.sees)
            if policy is not None:
                policy.save(folder / said[part]["policy"])
        said["planner"]["dt"] = self.planner.interface.policy_dt
        with written_whole(file) as beside:
            beside.write_text(write_yaml(said))
        _remove_unnamed(folder)
        return file


_OF_A_RUN = re.compile(r"(planner|residual)-\d+\.safetensors")  #: as `Hierarchy.write` names bundles


def _remove_unnamed(folder: Path) -> None:
    named = {name for path in folder.glob("*.yaml") for name in bundles_of(path)}
    for bundle in folder.glob("*.safetensors"):
        if bundle.name not in named and _OF_A_RUN.fullmatch(bundle.name):
            bundle.unlink()


def bundles_of(description: Path) -> list[str]:
    """The bundles that a description names; none if it is another kind of file."""
    said = read_yaml(description)
    if not isinstance(said, dict) or said.get("kind") != "hierarchical":
        return []
    members = (said["planner"]["policy"], said["residual"]["policy"])
    return [name for name in members if name.endswith(".safetensors")]


class PlannerAlone:
    """The deltas alone, in coarse steps; residuals are zero."""

    def __init__(self, hierarchy: Hierarchy) -> None:
        self._hierarchy = hierarchy

    def environments(self, envs: VecEnv) -> VecEnv:
        """The planner's part of them."""
        return MemberEnvs(envs, self._hierarchy.planner)

    def model(self, plan: Plan, normalise: VecNormalize) -> TimedPPO:
        """With the plan's network."""
        return ppo.make_single(plan, normalise)

    def save(self, model: TimedPPO, normalise: VecNormalize, folder: Path, name: str) -> Path:
        """As a description without residuals."""
        interface, golden = self._hierarchy.planner.interface, seen(model, normalise)
        planner = crossgait.Policy.from_sb3(model, interface, normalise, observations=golden)
        return self._hierarchy.write(folder, name, model.num_timesteps, planner, None)


class ResidualUnderPlanner:
    """The residuals in every step, under a planner that does not change any more."""

    def __init__(self, hierarchy: Hierarchy, planner: PolicyBundle) -> None:
        self._hierarchy, self._bundle = hierarchy, planner

    def __reduce__(self) -> tuple[Any, ...]:
        return _residual_under, (self._hierarchy, bytes_of(self._bundle))

    def environments(self, envs: VecEnv) -> VecEnv:
        """The residual policy's part of them."""
        h = self._hierarchy
        return MemberEnvs(envs, h.residual, (h.planner, self._bundle), h.period)

    def model(self, plan: Plan, normalise: VecNormalize) -> TimedPPO:
        """With the plan's network."""
        return ppo.make_single(plan, normalise)

    def save(self, model: TimedPPO, normalise: VecNormalize, folder: Path, name: str) -> Path:
        """As a description with the frozen planner beside it."""
        h, golden = self._hierarchy, seen(model, normalise)
        planner = crossgait.Policy.from_network(self._bundle.network, h.planner.interface)
        residual = crossgait.Policy.from_sb3(model, h.residual.interface, normalise, observations=golden)
        return h.write(folder, name, model.num_timesteps, planner, residual)


def _residual_under(hierarchy: Hierarchy, planner: bytes) -> ResidualUnderPlanner:
    return ResidualUnderPlanner(hierarchy, bundle_of(planner))


class BothTogether:
    """Both members go on from where they are, as one policy of PPO; the critic is the residual policy's."""

    def __init__(self, hierarchy: Hierarchy, planner: Path, residual: Path) -> None:
        """Of the folders that the members were trained in."""
        # By whole paths: workers find them from elsewhere.
        self._hierarchy, self._folders = hierarchy, (planner.resolve(), residual.resolve())

    def environments(self, envs: VecEnv) -> VecEnv:
        """All of them, and whether a plan is due."""
        return TwoPaceEnvs(envs, self._hierarchy.planner, self._hierarchy.period)

    def model(self, plan: Plan, normalise: VecNormalize) -> TimedPPO:
        """From the members' best networks, and the last exploration and critic."""
        h = self._hierarchy
        planner, residual = (read_bundle(folder, name) for folder, name in zip(self._folders, _MEMBERS, strict=True))
        slow, fast = map(checkpoint.read, self._folders)
        log_std = torch.empty(len(h.planner.action) + len(h.residual.action))
        for member, state in ((h.planner, slow), (h.residual, fast)):
            log_std[torch.as_tensor(member.action)] = state["policy"]["log_std"]
        start = Start(
            Normalised.of(planner.network, h.planner.observation),
            Normalised.of(residual.network, h.residual.observation),
            _critic(fast, h.residual, residual, normalise.epsilon),
            log_std,
        )
        checkpoint.restore_statistics(normalise.ret_rms, fast["return"])
        return ppo.make(plan, normalise, TwoPacePolicy, members=(h.planner, h.residual), start=start)

    def save(self, model: TimedPPO, normalise: VecNormalize, folder: Path, name: str) -> Path:
        """As a description with both members."""
        h, policy, golden = self._hierarchy, model.policy, seen(model, normalise)
        assert isinstance(policy, TwoPacePolicy)
        planner, residual = (
            crossgait.Policy.from_torch(
                net.layers,
                member.interface,
                normalisation=(net.mean.numpy(), net.std.numpy()),
                clip=net.clip,
                observations=None if golden is None else golden[:, member.observation],
            )
            for member, net in ((h.planner, policy.planner), (h.residual, policy.residual))
        )
        return h.write(folder, name, model.num_timesteps, planner, residual)


_MEMBERS = ("planner", "residual")


def read_bundle(folder: Path, member: str) -> PolicyBundle:
    """A member of the best policy in a folder."""
    description = folder / f"{BEST}.yaml"
    return PolicyBundle.read(str(folder / read_yaml(description)[member]["policy"]))


def _critic(state: Json, member: Member, bundle: PolicyBundle, epsilon: float) -> Normalised:
    """The value network of a single policy's checkpoint, which sees what its actor saw; `epsilon` is VecNormalize's."""
    weights = state["policy"]
    hidden = sorted(
        {name.rsplit(".", 1)[0] for name in weights if name.startswith("mlp_extractor.value_net.")},
        key=lambda name: int(name.rsplit(".", 1)[1]),
    )
    layers = linear_layers(
        [(weights[f"{name}.weight"], weights[f"{name}.bias"]) for name in (*hidden, "value_net")],
        bundle.network.activation,
    )
    seen = state["observation"]
    if seen is None:
        mean, std = torch.zeros(len(member.observation)), torch.ones(len(member.observation))
    else:
        mean, std = seen["mean"], torch.sqrt(seen["var"] + epsilon)
    return Normalised(layers, member.observation, mean, std, bundle.network.clip)


def train(
    plan: Plan, folder: Path, *, resume: bool, progress: bool | None = None, workers: Workers | None = None
) -> list[Trained]:
    """All parts of `plan` in order, each in a folder of its own; those that are done are not done again.

    Afterwards `best.yaml` in `folder` is the best of all parts' best.
    """
    done = []
    for name, learner in _learners(plan, folder):
        part = folder / name
        part.mkdir(exist_ok=True)
        how: Json = {"resume": resume, "progress": progress, "workers": workers}
        trainer = Trainer(plan.parts[name], part, learner=learner, title=name, **how)
        trainer.run()
        done.append(trainer.trained)
    best = max(done, key=lambda part: float(part.state["best"]["score"])).best
    for bundle in bundles_of(best):
        shutil.copy(best.parent / bundle, folder / bundle)
    with written_whole(folder / best.name) as beside:
        shutil.copy(best, beside)
    _remove_unnamed(folder)
    return done


def _learners(plan: Plan, folder: Path) -> Iterator[tuple[str, Learner]]:
    """Each is made when those before it are done."""
    hierarchy = Hierarchy.of(plan)
    yield "planner", PlannerAlone(hierarchy)
    yield "residual", ResidualUnderPlanner(hierarchy, read_bundle(folder / "planner", "planner"))
    yield "together", BothTogether(hierarchy, folder / "planner", folder / "residual")
