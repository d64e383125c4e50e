"""Small networks and the files that come with them, written as their frameworks write them."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

import crossgait

ROBOT = "serial_quadruped"
JOINTS = crossgait.Robot.load(ROBOT).servos  # FL FR RL RR: abduction, hip_pitch, knee
SDK = [3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8]
HOME = [0.0, 0.7, -1.4] * 4
KP = [30.0, 31.0, 32.0] * 4


def actor(observations: int, actions: int = 12) -> nn.Sequential:
    torch.manual_seed(2)
    return nn.Sequential(nn.Linear(observations, 24), nn.ELU(), nn.Linear(24, 16), nn.ELU(), nn.Linear(16, actions))


class Mixture(nn.Module):
    """Two experts under a softmax, and layer norm: no plain layers."""

    def __init__(self, observations: int) -> None:
        super().__init__()
        torch.manual_seed(3)
        self.norm = nn.LayerNorm(observations)
        self.gate, self.a, self.b = nn.Linear(observations, 2), nn.Linear(observations, 12), nn.Linear(observations, 12)

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        seen = self.norm(observation)
        shares = torch.softmax(self.gate(seen), dim=-1)
        return shares[:, :1] * self.a(seen) + shares[:, 1:] * self.b(seen)


class Remembering(nn.Module):
    """As rsl_rl exports recurrent actors: hidden states are buffers that the forward pass writes."""

    def __init__(self, observations: int) -> None:
        super().__init__()
        torch.manual_seed(4)
        self.rnn = nn.LSTM(observations, 8)
        self.actor = nn.Linear(8, 12)
        self.register_buffer("hidden_state", torch.zeros(1, 1, 8))
        self.register_buffer("cell_state", torch.zeros(1, 1, 8))

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        out, (h, c) = self.rnn(observation.unsqueeze(0), (self.hidden_state, self.cell_state))
        self.hidden_state[:] = h
        self.cell_state[:] = c
        return self.actor(out.squeeze(0))


class WithMemory(nn.Module):
    """As rsl_rl exports recurrent actors to ONNX: memory goes in and comes out."""

    def __init__(self, observations: int) -> None:
        super().__init__()
        torch.manual_seed(5)
        self.rnn, self.actor = nn.LSTM(observations, 8), nn.Linear(8, 12)

    def forward(self, obs: torch.Tensor, h: torch.Tensor, c: torch.Tensor) -> tuple[torch.Tensor, ...]:
        out, (h, c) = self.rnn(obs[None], (h, c))
        return self.actor(out[0]), h, c


class RememberingDrive(nn.Module):
    """As ETH's LSTM of an ANYmal's drives: (error, velocity) and its memory in, torque and memory out."""

    def __init__(self) -> None:
        super().__init__()
        self.lstm, self.linear = nn.LSTM(2, 8, 2, batch_first=True), nn.Linear(8, 1)

    def forward(
        self, x: torch.Tensor, memory: tuple[torch.Tensor, torch.Tensor]
    ) -> tuple[torch.Tensor, tuple[torch.Tensor, torch.Tensor]]:
        out, memory = self.lstm(x, memory)
        return self.linear(out[:, -1]), memory


def actuator(path: Path, remembers: bool, activation: nn.Module | None = None) -> str:
    """A network of a drive, as TorchScript."""
    torch.manual_seed(6)
    between = activation or nn.Softsign()
    plain = nn.Sequential(nn.Linear(6, 32), between, nn.Linear(32, 32), between, nn.Linear(32, 1))
    return export_script(RememberingDrive() if remembers else plain, path)


def quietly(function: Callable[..., Any]) -> Callable[..., Any]:
    """Without what exporters say of themselves."""

    def called(*args: Any, **options: Any) -> Any:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return function(*args, **options)

    return called


@quietly
def export_onnx(module: nn.Module, path: Path, observations: int, metadata: dict[str, str] | None = None) -> str:
    memory = [torch.zeros(1, 1, 8)] * 2 if isinstance(module, WithMemory) else []
    names = ["h", "c"][: len(memory)]
    torch.onnx.export(
        module.eval(),
        (torch.zeros(1, observations), *memory),
        str(path),
        input_names=["obs", *(f"{n}_in" for n in names)],
        output_names=["actions", *(f"{n}_out" for n in names)],
        dynamo=False,
    )
    if metadata is not None:
        import onnx

        model = onnx.load(str(path))
        for key, value in metadata.items():
            model.metadata_props.add(key=key, value=value)
        onnx.save(model, str(path))
    return str(path)


@quietly
def export_script(module: nn.Module, path: Path) -> str:
    torch.jit.script(module.eval()).save(str(path))
    return str(path)


def deploy_yaml(path: Path, history: int = 5, **changes: Any) -> str:
    """As unitree_rl_lab's export_deploy_cfg writes it: gains by motor, all else by the policy's joints."""

    def term(size: int, scale: float = 1.0) -> dict[str, Any]:
        return {"params": {}, "clip": [-100, 100], "scale": [scale] * size, "history_length": history}

    document: dict[str, Any] = {
        "joint_ids_map": SDK,
        "step_dt": 0.02,
        "stiffness": KP,
        "damping": [0.5] * 12,
        "default_joint_pos": HOME,
        "commands": {
            "base_velocity": {
                "ranges": {
                    "lin_vel_x": [-1.0, 1.0],
                    "lin_vel_y": [-0.5, 0.5],
                    "ang_vel_z": [-1.0, 1.0],
                    "heading": None,
                }
            }
        },
        "actions": {
            "JointPositionAction": {
                "clip": None,
                "joint_names": [".*"],
                "scale": [0.25] * 12,
                "offset": HOME,
                "joint_ids": None,
            }
        },
        "observations": {
            "base_ang_vel": term(3, 0.25),
            "projected_gravity": term(3),
            "velocity_commands": term(3),
            "joint_pos_rel": term(12),
            "joint_vel_rel": term(12, 0.05),
            "last_action": term(12),
        },
    }
    document.update(changes)
    path.write_text(json.dumps(document, indent=1))
    return str(path)


def mjlab_metadata(**changes: str) -> dict[str, str]:
    return {
        "run_path": "none",
        "joint_names": ",".join(JOINTS),
        "joint_stiffness": ",".join(map(str, KP)),
        "joint_damping": ",".join(["0.5"] * 12),
        "default_joint_pos": ",".join(map(str, HOME)),
        "command_names": "twist",
        "observation_names": "base_lin_vel,base_ang_vel,projected_gravity,joint_pos,joint_vel,actions,command",
        "observation_terms_scale": "1.0,0.25,1.0,1.0,0.05,1.0,1.0",
        "observation_terms_clip": "-inf;inf,-10;10,-inf;inf,-inf;inf,-inf;inf,-inf;inf,-inf;inf",
        "observation_terms_history_length": "0,0,0,0,0,0,0",
        "observation_terms_flatten_history_dim": "1,1,1,1,1,1,1",
        "action_scale": "0.25",
    } | changes


ENV_YAML = """\
sim:
  dt: 0.005
decimation: 4
episode_length_s: 20.0
scene:
  robot:
    init_state:
      pos: !!python/tuple [0.0, 0.0, 0.4]
      joint_pos:
        .*_abduction: 0.0
        .*_hip_pitch: 0.7
        .*_knee: -1.4
    actuators:
      legs:
        class_type: isaaclab.actuators.actuator_pd:DCMotor
        joint_names_expr: ['.*']
        effort_limit: 23.5
        saturation_effort: 47.0
        velocity_limit: 30.0
        stiffness: 25.0
        damping: 0.5
        friction: 0.0
  terrain:
    physics_material:
      static_friction: 0.9
  height_scanner:
    pattern_cfg:
      resolution: 0.5
      size: [1.0, 0.5]
      ordering: xy
observations:
  policy:
    concatenate_terms: true
    history_length: null
    base_ang_vel:
      func: isaaclab.envs.mdp.observations:base_ang_vel
      params: {}
      noise: {func: isaaclab.utils.noise.noise_model:uniform_noise, n_min: -0.2, n_max: 0.2}
      clip: !!python/tuple [-100.0, 100.0]
      scale: 0.25
      history_length: 0
    projected_gravity: {func: isaaclab.envs.mdp.observations:projected_gravity, scale: null, history_length: 0}
    velocity_commands: {func: isaaclab.envs.mdp.observations:generated_commands, scale: null, history_length: 0}
    joint_pos: {func: isaaclab.envs.mdp.observations:joint_pos_rel, scale: 1.0, history_length: 0}
    joint_vel: {func: isaaclab.envs.mdp.observations:joint_vel_rel, scale: 0.05, history_length: 0}
    actions: {func: isaaclab.envs.mdp.observations:last_action, scale: null, history_length: 0}
    height_scan:
      func: isaaclab.envs.mdp.observations:height_scan
      params: {sensor_cfg: {name: height_scanner}}
      clip: !!python/tuple [-1.0, 1.0]
      scale: null
      history_length: 0
  critic:
    anything: {func: elsewhere:not_ours}
actions:
  joint_pos:
    class_type: isaaclab.envs.mdp.actions.joint_actions:JointPositionAction
    joint_names: ['.*']
    scale: 0.25
    offset: 0.0
    preserve_order: false
    use_default_offset: true
    clip: null
commands:
  base_velocity:
    ranges: {lin_vel_x: !!python/tuple [0.0, 0.3], lin_vel_y: !!python/tuple [0.0, 0.0]}
"""
#: As Isaac Lab writes the configuration of a perceptron on the past of two joint quantities.
ACTUATOR_MLP = """\
network_file: drive.pt
        input_order: vel_pos
        input_idx: [0, 2, 4]
        pos_scale: -1.0
        vel_scale: 0.1
        torque_scale: 20.0"""
ENV_YAML_OBSERVATIONS = 3 + 3 + 3 + 12 + 12 + 12 + 3 * 2

AGENT_YAML = """\
seed: 1
num_steps_per_env: 24
policy:
  class_name: {kind}
  activation: elu
  actor_hidden_dims: [24, 16]
  rnn_type: lstm
algorithm:
  class_name: PPO
"""

LEGGED_GYM = """\
from legged_gym.envs.base.legged_robot_config import LeggedRobotCfg, LeggedRobotCfgPPO

raise SystemExit("a configuration is read, never executed")


class SmallRoughCfg(LeggedRobotCfg):
    class init_state(LeggedRobotCfg.init_state):
        pos = [0.0, 0.0, 0.42]
        default_joint_angles = {joints}

    class control(LeggedRobotCfg.control):
        control_type = "P"
        stiffness = {{"abduction": 20.0, "hip": 10 * 2.0, "knee": 20.0}}
        damping = {{"abduction": 0.5, "hip": 0.5, "knee": 0.5}}
        action_scale = 1 / 4
        decimation = 4

    class sim:
        dt = 0.005

    class env:
        num_observations = {observations}

    class normalization:
        clip_actions = 100.0
        class obs_scales:
            lin_vel = 2.0


class SmallRoughCfgPPO(LeggedRobotCfgPPO):
    class policy:
        activation = "elu"
"""


def legged_gym(path: Path, observations: int = 48) -> str:
    joints = dict(zip(JOINTS, HOME, strict=True))
    path.write_text(LEGGED_GYM.format(joints=joints, observations=observations))
    return str(path)


def rl_sar(path: Path, **changes: Any) -> str:
    motors = [JOINTS[i] for i in SDK]
    document: dict[str, Any] = {
        "model_name": "policy.pt",
        "num_observations": 45,
        "observations": ["commands", "ang_vel", "gravity_vec", "dof_pos", "dof_vel", "actions"],
        "observations_history": [0, 1, 2],
        "observations_history_priority": "time",
        "clip_obs": 100.0,
        "clip_actions_lower": [-50.0] * 12,
        "clip_actions_upper": [50.0] * 12,
        "rl_kp": [25.0] * 12,
        "rl_kd": [0.5] * 12,
        "num_of_dofs": 12,
        "action_scale": [0.25] * 12,
        "ang_vel_scale": 0.25,
        "dof_pos_scale": 1.0,
        "dof_vel_scale": 0.05,
        "commands_scale": [2.0, 2.0, 0.25],
        "torque_limits": [30.0] * 12,
        "default_dof_pos": HOME,
        "joint_names": motors,
        "joint_mapping": SDK,
        "dt": 0.005,
        "decimation": 4,
    }
    document.update(changes)
    path.write_text(json.dumps({"robot/walk": document}, indent=1))
    return str(path)


def checkpoint(path: Path, observations: int, recurrent: bool = False) -> tuple[str, nn.Module]:
    """As rsl_rl saves a run: weights, statistics of observations, nothing about what is between the layers."""
    module = actor(8 if recurrent else observations)
    state = {f"actor.{key}": value for key, value in module.state_dict().items()}
    state["std"] = torch.ones(12)
    state |= {f"critic.{i}.weight": torch.zeros(2, 2) for i in (0, 2)}
    rng = np.random.default_rng(8)
    state["actor_obs_normalizer._mean"] = torch.tensor(rng.normal(0, 0.3, (1, observations)), dtype=torch.float32)
    state["actor_obs_normalizer._std"] = torch.tensor(rng.uniform(0.5, 2, (1, observations)), dtype=torch.float32)
    rnn = None
    if recurrent:
        torch.manual_seed(6)
        rnn = nn.LSTM(observations, 8)
        state |= {f"memory_a.rnn.{key}": value for key, value in rnn.state_dict().items()}
    torch.save({"model_state_dict": state, "iter": 10, "infos": None}, str(path))
    return str(path), Checked(state, module, rnn)


class Checked(nn.Module):
    """What a checkpoint's actor computes, with its memory."""

    def __init__(self, state: dict[str, torch.Tensor], layers: nn.Module, rnn: nn.LSTM | None) -> None:
        super().__init__()
        self.mean, self.std = state["actor_obs_normalizer._mean"], state["actor_obs_normalizer._std"]
        self.layers, self.rnn = layers, rnn
        self.memory: Any = None

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        seen = (observation - self.mean) / (self.std + 1e-2)
        if self.rnn is None:
            return self.layers(seen)
        out, self.memory = self.rnn(seen[None], self.memory)
        return self.layers(out[0])
