"""Configurations of environments as Python objects: keywords, attributes, dicts."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, EnvironmentConfig
from crossgait.sweep.strict_yaml import parse_yaml

POLICIES = Path(crossgait.models_dir()) / "policies"
CONFIGS = {
    "default": EnvironmentConfig(),
    "guide": EnvironmentConfig(preset="guide"),
    "joints": EnvironmentConfig(action="joints"),
    "everything of a gait": EnvironmentConfig(
        engine="bullet:matched",
        terrain="rough:amplitude=.01",
        terrain_seed=2**63,
        servos={"kp": {"all": 20, "FL_tilt": 30.5}, "kd": 0.5},
        gait="walk",
        parameters={"step_length": 0.1 / 3, "swing": "matched"},
        adapt=["step_length", "stance_width"],
        ranges={"step_length": (0, 0.08)},
        delta_scales={"step_length": 1e-5},
        residual_scale=0.02,
        command={"vx": 0.1, "yaw_rate": -0.3},
        observation=["gravity", {"block": "joint_positions", "scale": 2, "clip": 5, "history": 3}],
        reward={"alive": 0.25},
        randomisation={"friction": [0.5, 1.5], "terrain_seed": [3, 9]},
        terminations=["collapsed"],
    ),
    "everything of joints": EnvironmentConfig(
        robot="serial_quadruped", action="joints", joints={"scale": 0.3, "limit": 2, "delay": 0.004}, reward={}
    ),
} | {
    folder.name: EnvironmentConfig.load(folder / "environment.yaml") for folder in POLICIES.iterdir() if folder.is_dir()
}


@pytest.fixture(params=CONFIGS)
def config(request: pytest.FixtureRequest) -> EnvironmentConfig:
    return CONFIGS[request.param]


def test_the_dict_is_the_yaml(config: EnvironmentConfig) -> None:
    assert config.to_dict() == parse_yaml(config.to_yaml(), "environment")
    assert list(config.to_dict()) == list(parse_yaml(config.to_yaml(), "environment"))


def test_what_is_written_reads_back(config: EnvironmentConfig) -> None:
    assert EnvironmentConfig.from_dict(config.to_dict()) == config
    assert EnvironmentConfig(**config.to_dict()) == config
    assert pickle.loads(pickle.dumps(config)) == config
    assert eval(repr(config), {"EnvironmentConfig": EnvironmentConfig}) == config


def test_attributes_are_the_keys_of_the_dict(config: EnvironmentConfig) -> None:
    said = config.to_dict()
    for key, value in said.items():
        assert getattr(config, key) == value
        assert type(getattr(config, key)) is type(value)
    unsaid = {"contact": {}, "servos": {}, "randomisation": {}, "parameters": {}, "ranges": {}, "delta_scales": {}}
    of_a_gait = {"gait", "parameters", "adapt", "ranges", "delta_scales", "residual_scale", "heading_hold"}
    keys = {name for name, value in vars(EnvironmentConfig).items() if isinstance(value, property)}
    keys -= {"terms", "notes"}  # functions, and what is said of all keys: no keys
    assert len(keys) == 27  # of docs/environment.md, but for preset
    for key in keys - said.keys():
        of_the_other = key == "joints" if config.action == "gait" else key in of_a_gait
        assert getattr(config, key) == (None if of_the_other else unsaid.get(key))


def test_without_arguments_it_is_the_default() -> None:
    assert EnvironmentConfig() == EnvironmentConfig.parse("{}") == EnvironmentConfig(terrain=None, command=None)
    assert EnvironmentConfig().policy_dt == 2e-3
    assert EnvironmentConfig().command is None


def test_numpy_and_paths_are_taken(tmp_path: Path) -> None:
    file = tmp_path / "ground.csv"
    file.write_text("0,0\n0,0\n")
    keys: dict[str, Any] = {"friction": np.float32(0.5), "terrain_seed": np.int64(3), "terrain": file}
    keys |= {"randomisation": {"friction": np.array([0.5, 1.5])}, "heading_hold": np.False_}
    made = EnvironmentConfig.from_dict(keys)
    assert (made.friction, made.terrain_seed, made.heading_hold) == (0.5, 3, False)
    assert made.randomisation == {"friction": [0.5, 1.5]}
    assert made.terrain == str(file)


def test_changes_come_on_top_key_by_key() -> None:
    base = EnvironmentConfig(reward={"alive": 1}, friction=0.5)
    made = base.updated({"friction": 0.7}, terrain="rough", command=None)
    assert made.to_dict() == base.to_dict() | {"friction": 0.7, "terrain": "rough"}
    assert base.updated("friction: 0.7\nterrain: rough") == made
    assert base.updated() == base
    assert base.friction == 0.5


def test_what_is_wrong_is_named() -> None:
    with pytest.raises(ConfigError, match=r"EnvironmentConfig: .*expected one of the keys preset, engine.*'terain'"):
        EnvironmentConfig(terain="rough")  # type: ignore[call-arg]
    with pytest.raises(ConfigError, match=r"friction: expected a finite number, found 'high'"):
        EnvironmentConfig.from_dict({"friction": "high"})
    with pytest.raises(ConfigError, match=r"mine: .*friction"):
        EnvironmentConfig.from_dict({"friction": float("nan")}, "mine")
    with pytest.raises(ConfigError, match="numbers, text, lists and mappings, found object"):
        EnvironmentConfig.from_dict({"friction": object()})
    with pytest.raises(AttributeError):
        EnvironmentConfig().friction = 1  # type: ignore[misc]
