from __future__ import annotations

import json
import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
import training

import crossgait
from crossgait import ConfigError, EnvironmentConfig
from crossgait.policies import MlpNetwork, Policy
from crossgait.policies.environment import environment_of
from crossgait.train.compare_policies import compare_policies, table
from crossgait.viewing.play import play

SHORT = {
    "policy_dt": 0.02,
    "episode_seconds": 0.4,
    "settle_seconds": 0.02,
    "adapt": ["step_length"],
    "reward": {"forward_velocity": 1},
    "randomisation": {"terrain_seed": [0, 99], "start_yaw": [-0.2, 0.2]},
    "terrain": "rough",
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an environment and a policy that shortens every step."""
    folder = tmp_path_factory.mktemp("run")
    config = EnvironmentConfig.parse(json.dumps(SHORT), "environment")
    (folder / "environment.yaml").write_text(config.to_yaml())
    layout = Policy.load("zero", config).layout
    bias = np.zeros(len(layout.action), np.float32)
    bias[layout.action.index("delta.step_length")] = -1
    network = MlpNetwork([(np.zeros((len(bias), len(layout.observation)), np.float32), bias)])
    Policy.from_network(network, config).save(folder / "short.safetensors")
    return folder


def test_policies_meet_the_same_episodes_in_every_engine(run: Path) -> None:
    config = EnvironmentConfig.load(str(run / "environment.yaml"))
    policy = str(run / "short.safetensors")
    told = compare_policies([policy, "zero"], config, terrains=["rough", "flat"], episodes=2, seed=5)
    engines = crossgait.available_engines()
    expected = [(t, e, p) for t in ("rough", "flat") for e in engines for p in (policy, "zero")]
    assert [(c["terrain"], c["engine"], c["policy"]) for c in told["cells"]] == expected
    for terrain, engine, name in expected:
        alone = crossgait.rollout(
            name, config.updated(json.dumps({"terrain": terrain, "engine": engine}), "t"), episodes=2, seed=5
        ).document["policies"][0]["all"]
        (cell,) = (c for c in told["cells"] if (c["terrain"], c["engine"], c["policy"]) == (terrain, engine, name))
        assert cell["all"] == alone
    speeds = [cell["all"]["mean_speed_mps"]["mean"] for cell in told["cells"]]
    assert all(short < zero for short, zero in zip(speeds[::2], speeds[1::2], strict=True))
    text = table(told)
    assert len(text.splitlines()) == 2 + len(expected)
    assert f"{speeds[0]:.4g} ± " in text


def test_the_environment_beside_a_policy_is_taken(run: Path, tmp_path: Path) -> None:
    beside = environment_of(["zero", str(run / "short.safetensors")], None)
    assert beside == EnvironmentConfig.load(str(run / "environment.yaml"))
    with pytest.raises(ConfigError, match="or --environment"):
        environment_of(["zero", "random"], None)
    out, _ = training.done(
        [
            *("-m", "crossgait.train.compare_policies", str(run / "short.safetensors"), "zero"),
            *("--engines", "mujoco", "--episodes", "1", "--json", "-"),
        ],
        tmp_path,
    )
    assert len(json.loads(out)["cells"]) == 2
    _, err = training.done(["-m", "crossgait.train.compare_policies", "zero"], tmp_path, code=2)
    assert err.startswith("crossgait.train.compare_policies: zero: environment: expected environment.yaml beside")


def test_a_video_shows_an_episode(run: Path, tmp_path: Path) -> None:
    config = EnvironmentConfig.load(str(run / "environment.yaml"))
    told = play(str(run / "short.safetensors"), config, video=tmp_path / "a.mp4", seed=3, size=(96, 64))
    assert told["simulated_seconds"] == pytest.approx(0.4)
    decode = [
        imageio_ffmpeg.get_ffmpeg_exe(),
        "-i",
        str(tmp_path / "a.mp4"),
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-",
    ]
    decoded = subprocess.run(decode, capture_output=True, check=True, timeout=100).stdout
    frames = np.frombuffer(decoded, np.uint8).reshape(-1, 64, 96, 3).astype(float)
    assert frames.shape == (11, 64, 96, 3)  # 25 a second, the start among them
    assert np.abs(frames[-1] - frames[0]).mean() > 1  # of 255: it moves over a ground with lines
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]


def test_what_cannot_be_played(run: Path, tmp_path: Path) -> None:
    policy = str(run / "short.safetensors")
    for arguments, words in (
        ([policy, "--video", "a.avi"], "a.avi: file: expected one that ends in .mp4 or .gif"),
        ([policy, "--video", "a.mp4", "--size", "3"], "--size: expected WIDTHxHEIGHT"),
        ([policy, "--video", "a.mp4", "--engine", "havok"], "havok"),
        ([policy, "--video", "a.mp4", "--terrain", "moon"], "moon"),
    ):
        _, err = training.done(["-m", "crossgait.viewing.play", *arguments], tmp_path, code=2)
        assert words in err
    assert not list(tmp_path.iterdir())
