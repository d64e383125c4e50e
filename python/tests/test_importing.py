"""Published policies, imported: every form, what it says of each field, and that the network acts as before."""

from __future__ import annotations

import fcntl
import json
import math
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest

import crossgait
from crossgait.errors import ConfigError

torch = pytest.importorskip("torch")
pytest.importorskip("onnx")
pytest.importorskip("onnxruntime")

import published_policies as published  # noqa: E402
from published_policies import HOME, JOINTS, KP, ROBOT, SDK  # noqa: E402

OBSERVATIONS = 45


@pytest.fixture(autouse=True)
def quiet():
    torch.set_num_threads(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of exporters that PyTorch calls deprecated, and their traces
        yield


def by_field(imported):
    return {field.name: field for field in imported.fields}


def act_like(imported, module, tolerance=1e-5, steps=6):
    """Whether the imported policy does what `module` does from raw observations, step by step."""
    policy = crossgait.Policy.load(imported.folder, crossgait.EnvironmentConfig.load(imported.environment_file))
    random = np.random.default_rng(1)
    policy.reset()
    for _ in range(steps):
        observation = random.normal(0, 0.3, len(policy.layout.observation)).astype(np.float32)
        with torch.no_grad():
            expected = module(torch.from_numpy(observation[None])).numpy().reshape(-1)
        # Sums of some hundred products in single precision, in another order.
        np.testing.assert_allclose(policy.act(observation.astype(float)), expected, atol=tolerance)
    return policy


@pytest.fixture
def deployed(tmp_path):
    size = 5 * OBSERVATIONS
    network = published.Mixture(size)
    file = published.export_onnx(network, tmp_path / "policy.onnx", size)
    return network, file, published.deploy_yaml(tmp_path / "deploy.yaml")


def test_deploy_yaml_says_everything_but_what_is_listed(tmp_path, deployed):
    network, file, deploy = deployed
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy)
    act_like(imported, network)
    fields = by_field(imported)
    # joint_ids_map names motors, of which the convention is FR FL RR RL: the policy's first is FL.
    assert fields["joints.order"].value == list(JOINTS)
    assert "deploy.yaml: line" in fields["joints.order"].source
    assert "convention unitree-sdk" in fields["joints.order"].source
    assert fields["joints.home"].value == dict(zip(JOINTS, HOME, strict=True))
    assert fields["servos.kp"].value == {JOINTS[motor]: KP[i] for i, motor in enumerate(SDK)}
    assert fields["history.order"].value == "oldest_first"
    assert fields["policy_dt"].value == 0.02
    assert "physics_dt" in imported.unstated
    assert fields["physics_dt"].source == "default"
    assert "policy_dt" not in imported.unstated
    # The last of a term's five instants is the present one.
    names = crossgait.Policy.load(imported.folder, imported.environment_file).layout.observation.names
    assert names[:3] == ("w_B.x@0.08", "w_B.y@0.08", "w_B.z@0.08")
    assert names[12:15] == ("w_B.x", "w_B.y", "w_B.z")


def test_the_folder_runs_where_policies_do(tmp_path, deployed):
    _, file, deploy = deployed
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy)
    short = crossgait.EnvironmentConfig.load(imported.environment_file).updated(episode_seconds=0.2)
    result = crossgait.rollout([imported.folder], short, episodes=1)
    again = crossgait.rollout([imported.folder], short, episodes=1)
    assert result.to_frame().equals(again.to_frame())
    # Without an environment it runs in its own.
    assert crossgait.rollout([imported.folder], episodes=1, workers=1).to_frame() is not None


def test_unknown_keys_are_listed(tmp_path, deployed):
    _, file, _ = deployed
    deploy = published.deploy_yaml(tmp_path / "more.yaml", made_by="somebody", other={"deep": 1})
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy)
    assert [text.split(" ")[0] for text in imported.unread] == ["made_by", "other"]


def test_contradictions_name_both_places(tmp_path, deployed):
    _, file, deploy = deployed
    other = published.deploy_yaml(tmp_path / "other.yaml", damping=[1.0] * 12)
    with pytest.raises(ConfigError, match=r"other.yaml: line \d+: servos.kd: expected 0.5 .*deploy.yaml: line \d+"):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", [deploy, other])


def test_what_the_caller_says_replaces_what_files_say_and_tells(tmp_path, deployed):
    _, file, deploy = deployed
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy, settings={"servos.kd": 2})
    field = by_field(imported)["servos.kd"]
    assert set(field.value.values()) == {2.0}
    assert field.source.startswith("settings, where deploy.yaml: line")
    assert imported.environment["servos"]["kd"] == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joint_ids_map": [0] * 12}, r"joint_ids_map: expected each of 0 to 11 once"),
        ({"stiffness": [1.0]}, r"stiffness: expected 12 numbers, found 1"),
        ({"step_dt": "fast"}, r"step_dt: expected a finite number, found 'fast'"),
        ({"actions": {"JointVelocityAction": {}}}, r"actions: expected JointPositionAction alone"),
        ({"observations": {"smell": {"scale": None}}}, r"observations.smell: expected a term that Crossgait has"),
        ({"observations": {"base_ang_vel": {"clip": [-1, 5]}}}, r"clip: expected limits of the same size"),
        ({"observations": {}}, r"observations: expected at least one term, found none"),
        ({"joint_names": ["a"]}, r"joint names: expected each servo of serial_quadruped once"),
    ],
)
def test_what_cannot_be_said_is_refused_by_name(tmp_path, deployed, changes, message):
    _, file, _ = deployed
    deploy = published.deploy_yaml(tmp_path / "bad.yaml", **changes)
    with pytest.raises(ConfigError, match=message):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy)


def test_a_network_of_another_size_is_refused(tmp_path, deployed):
    _, file, _ = deployed
    deploy = published.deploy_yaml(tmp_path / "short.yaml", history=4)
    with pytest.raises(ConfigError, match=r"observation: expected one of 180 numbers.*obs of 225"):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy)


def test_mjlab_metadata(tmp_path):
    network = published.actor(48)
    file = published.export_onnx(network, tmp_path / "policy.onnx", 48, published.mjlab_metadata())
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk")
    act_like(imported, network)
    assert imported.policy.endswith("walk.safetensors")  # plain layers need no ONNX Runtime
    fields = by_field(imported)
    assert fields["servos.kp"].source == "policy.onnx: metadata joint_stiffness"
    assert fields["observation.base_angular_velocity_local"].value == {"scale": 0.25, "clip_unscaled": 10.0}
    assert "policy_dt" in imported.unstated


def test_mjlab_metadata_of_other_lengths_is_refused(tmp_path):
    metadata = published.mjlab_metadata(observation_terms_scale="1.0,0.25")
    file = published.export_onnx(published.actor(48), tmp_path / "policy.onnx", 48, metadata)
    with pytest.raises(ConfigError, match="metadata observation_terms_scale: expected 7 elements"):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk")


def test_onnx_with_memory_forgets_at_reset(tmp_path):
    network = published.WithMemory(48)
    file = published.export_onnx(network, tmp_path / "policy.onnx", 48, published.mjlab_metadata())
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk")

    class Alone(torch.nn.Module):
        memory = (torch.zeros(1, 1, 8), torch.zeros(1, 1, 8))

        def forward(self, observation):
            action, *self.memory = network(observation, *self.memory)
            return action

    policy = act_like(imported, Alone())
    observation = np.full(48, 0.2)
    policy.reset()
    first, second = policy.act(observation), policy.act(observation)
    assert np.abs(first - second).max() > 1e-3
    policy.reset()
    np.testing.assert_array_equal(policy.act(observation), first)


def test_isaac_lab_env_yaml(tmp_path):
    size = published.ENV_YAML_OBSERVATIONS
    network = published.actor(size)
    file = published.export_script(network, tmp_path / "policy.pt")
    (tmp_path / "env.yaml").write_text(published.ENV_YAML)
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", tmp_path / "env.yaml")
    act_like(imported, network)
    fields = by_field(imported)
    breadth_first = [f"{leg}_{part}" for part in ("abduction", "hip_pitch", "knee") for leg in ("FL", "FR", "RL", "RR")]
    assert fields["joints.order"].value == breadth_first
    assert fields["policy_dt"].value == pytest.approx(0.02)
    assert fields["friction"].value == 0.9
    # Half the stall torque is reached at half the speed at which there is none.
    assert imported.environment["servos"]["corner_speed"] == 15
    assert imported.environment["servos"]["no_load_speed"] == 30
    assert imported.environment["height_scan"] == {
        "x": [-0.5, 0, 0.5],
        "y": [-0.25, 0.25],
        "offset": 0.5,
        "x_first": True,
    }
    assert imported.environment["command"]["vx"] == 0.3  # within what it was trained for


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("actuator_pd:DCMotor", "actuator_pd:RemotizedPDActuator", "expected one of ImplicitActuator.*RemotizedPD"),
        ("actuator_pd:DCMotor", "actuator_net:ActuatorNetMLP", "legs.network_file: expected a value, found none"),
        ("mdp.actions.joint_actions:JointPositionAction", "x:BinaryJointAction", "class_type: expected one of Joint"),
        ("modifiers", "modifiers", ""),
    ],
)
def test_what_isaac_lab_has_and_crossgait_not(tmp_path, old, new, message):
    if not message:
        old, new = "observations:base_ang_vel\n", "observations:base_ang_vel\n      modifiers: [{func: x}]\n"
        message = "modifiers: expected null"
    file = published.export_script(published.actor(51), tmp_path / "policy.pt")
    assert old in published.ENV_YAML
    (tmp_path / "env.yaml").write_text(published.ENV_YAML.replace(old, new))
    with pytest.raises(ConfigError, match=message):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", tmp_path / "env.yaml")


def test_implicit_actuators_are_servos_of_the_law_drive(tmp_path):
    text = published.ENV_YAML.replace("actuator_pd:DCMotor", "actuator_pd:ImplicitActuator")
    imported = imported_from(tmp_path, text.replace("        saturation_effort: 47.0\n", ""))
    servos = imported.environment["servos"]
    assert servos["implicit_stiffness"] == servos["implicit_damping"] == 1.0
    field = next(f for f in imported.fields if f.name == "servos.implicit_damping")
    assert "env.yaml" in field.source
    (tmp_path / "explicit").mkdir()
    explicit = imported_from(tmp_path / "explicit", published.ENV_YAML)
    assert "implicit_damping" not in explicit.environment["servos"]


def imported_from(tmp_path, text, observations=51):
    """A network of that size under that env.yaml."""
    file = published.export_script(published.actor(observations), tmp_path / "policy.pt")
    (tmp_path / "env.yaml").write_text(text)
    return crossgait.import_policy(file, ROBOT, tmp_path / "walk", tmp_path / "env.yaml")


def test_observed_joints_keep_the_articulations_order_whatever_actions_do(tmp_path):
    names = "[" + ", ".join(JOINTS) + "]"
    text = published.ENV_YAML.replace("joint_names: ['.*']\n    scale", f"joint_names: {names}\n    scale")
    imported = imported_from(tmp_path, text.replace("preserve_order: false", "preserve_order: true"))
    breadth_first = [f"{leg}_{part}" for part in ("abduction", "hip_pitch", "knee") for leg in ("FL", "FR", "RL", "RR")]
    assert imported.environment["joints"]["order"] == list(JOINTS)
    assert imported.environment["joints"]["observed"] == breadth_first
    layout = crossgait.Policy.load(imported.folder, imported.environment_file).layout
    assert layout.observation.names[9:13] == tuple(f"dq.{leg}_abduction" for leg in ("FL", "FR", "RL", "RR"))
    assert layout.observation.names[33:36] == tuple(f"last.target.{joint}" for joint in JOINTS[:3])


def test_terms_that_show_other_joints_say_so(tmp_path):
    asset = "params: {asset_cfg: {name: robot, joint_names: [RR_knee, FL_knee], preserve_order: true}}"
    terms = [f"observations:joint_{what}_rel, scale" for what in ("pos", "vel")]
    text = published.ENV_YAML
    for term in terms:
        text = text.replace(term, term.replace(", scale", f", {asset}, scale"))
    imported = imported_from(tmp_path, text, observations=published.ENV_YAML_OBSERVATIONS - 20)
    assert imported.environment["joints"]["observed"] == ["RR_knee", "FL_knee"]
    one = text.replace(f"joint_vel_rel, {asset}", "joint_vel_rel")
    with pytest.raises(ConfigError, match=r"joints.observed: expected RR_knee, FL_knee, as env.yaml: line \d+"):
        imported_from(tmp_path, one)


SEVERAL_ACTIONS = """\
actions:
  legs:
    class_type: isaaclab.envs.mdp.actions.joint_actions:JointPositionAction
    joint_names: ['.*_abduction', '.*_hip_pitch']
    scale: 0.25
    use_default_offset: true
  knees:
    class_type: isaaclab.envs.mdp.actions.joint_actions:JointVelocityAction
    joint_names: ['.*_knee']
    scale: 5.0
    offset: 0.0
    clip: {'.*': !!python/tuple [-4.0, 4.0]}
"""


def test_several_action_terms_are_one_action(tmp_path):
    head, _, tail = published.ENV_YAML.partition("actions:\n  joint_pos")
    text = head + SEVERAL_ACTIONS + "commands" + tail.partition("commands")[2]
    joints = imported_from(tmp_path, text).environment["joints"]
    knees = [f"{leg}_knee" for leg in ("FL", "FR", "RL", "RR")]
    assert joints["order"][8:] == knees
    assert joints["command"] == {"all": "position", **dict.fromkeys(knees, "velocity")}
    assert {joints["scale"][knee] for knee in knees} == {5.0}
    assert {joints["upper"][knee] for knee in knees} == {4.0}
    assert "FL_abduction" not in joints["upper"]
    with pytest.raises(ConfigError, match="joints that no other action term moves, found FL_knee"):
        imported_from(tmp_path, text.replace("'.*_hip_pitch'", "'.*_hip_pitch', '.*_knee'"))
    with pytest.raises(ConfigError, match=r"action terms of every servo.*found none of RL_knee, RR_knee"):
        imported_from(tmp_path, text.replace("['.*_knee']", "['F.*_knee']"))


@pytest.mark.parametrize("remembers", [False, True])
def test_networks_of_actuators_are_taken_along(tmp_path, remembers):
    published.actuator(tmp_path / "drive.pt", remembers)
    kind = "ActuatorNetLSTM" if remembers else "ActuatorNetMLP"
    said = "network_file: /nowhere/drive.pt" if remembers else published.ACTUATOR_MLP
    text = published.ENV_YAML.replace("actuator_pd:DCMotor", f"actuator_net:{kind}").replace(
        "        stiffness: 25.0\n        damping: 0.5\n", f"        {said}\n"
    )
    imported = imported_from(tmp_path, text)
    assert imported.environment["joints"]["actuator"].endswith("walk/actuator.safetensors")
    assert imported.environment["settle_seconds"] == 0
    # What a motor gives at its speed is the network's limit as well.
    assert imported.environment["servos"]["no_load_speed"] == 30
    short = crossgait.EnvironmentConfig.load(imported.environment_file).updated(episode_seconds=0.2)
    crossgait.rollout([imported.folder], short, episodes=1)
    (tmp_path / "drive.pt").unlink()
    with pytest.raises(ConfigError, match=r"a file there, or drive.pt beside the file that says so"):
        imported_from(tmp_path, text)


def test_another_network_of_actuators_is_refused(tmp_path):
    published.actuator(tmp_path / "drive.pt", False, torch.nn.Sigmoid())
    text = published.ENV_YAML.replace("actuator_pd:DCMotor", "actuator_net:ActuatorNetMLP").replace(
        "        stiffness: 25.0\n        damping: 0.5\n", f"        {published.ACTUATOR_MLP}\n"
    )
    with pytest.raises(ConfigError, match=r"network: expected layers.*softsign.*which computes otherwise"):
        imported_from(tmp_path, text)


def test_a_start_that_the_caller_says_begins_at_once(tmp_path, deployed):
    _, file, deploy = deployed
    settings = {"start.height": 0.5, "start.velocity": [0.2, 0, 0]}
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy, settings=settings)
    assert imported.environment["start"] == {"height": 0.5, "velocity": [0.2, 0, 0]}
    assert imported.environment["settle_seconds"] == 0


@pytest.mark.parametrize("recurrent", [False, True])
def test_checkpoints_with_agent_yaml(tmp_path, recurrent):
    size = published.ENV_YAML_OBSERVATIONS
    file, module = published.checkpoint(tmp_path / "model_10.pt", size, recurrent)
    (tmp_path / "env.yaml").write_text(published.ENV_YAML)
    (tmp_path / "agent.yaml").write_text(published.AGENT_YAML)
    with pytest.raises(ConfigError, match=r"architecture: expected agent\.yaml"):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", tmp_path / "env.yaml")
    sources = [tmp_path / "env.yaml", tmp_path / "agent.yaml"]
    act_like(crossgait.import_policy(file, ROBOT, tmp_path / "walk", sources), module)


@pytest.mark.parametrize("observations", [48, 235])
def test_legged_gym_classes_are_read_and_not_executed(tmp_path, observations):
    network = published.actor(observations)
    file = published.export_script(network, tmp_path / "policy.pt")
    config = published.legged_gym(tmp_path / "small_config.py", observations)
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", config)
    act_like(imported, network)
    fields = by_field(imported)
    assert fields["joints.home"].value == dict(zip(JOINTS, HOME, strict=True))
    assert set(fields["servos.kp"].value.values()) == {20.0}
    assert set(fields["joints.scale"].value.values()) == {0.25}
    assert "small_config.py: line" in fields["policy_dt"].source
    assert fields["observation.command"].value == {"clip": 100.0, "scale": [2.0, 2.0, 0.25]}
    assert ("height_scan" in fields) == (observations == 235)


class Planted:
    """What a pickle may hold: unpickled, it makes a file."""

    def __init__(self, file):
        self.file = file

    def __reduce__(self):
        return os.mkdir, (self.file,)


def test_checkpoints_are_read_and_not_executed(tmp_path):
    torch = pytest.importorskip("torch")
    made = tmp_path / "made"
    torch.save({"model_state_dict": {}, "infos": Planted(str(made))}, tmp_path / "model.pt")
    (tmp_path / "agent.yaml").write_text(published.AGENT_YAML)
    (tmp_path / "env.yaml").write_text(published.ENV_YAML)
    with pytest.raises(ConfigError, match="expected a checkpoint of tensors alone"):
        crossgait.import_policy(
            tmp_path / "model.pt", ROBOT, tmp_path / "walk", [tmp_path / "env.yaml", tmp_path / "agent.yaml"]
        )
    assert not made.exists()
    torch.load(tmp_path / "model.pt", weights_only=False)
    assert made.exists(), "whoever executes it would have made the folder"


def test_checkpoints_of_tensors_that_are_no_plain_numbers_are_read(tmp_path):
    torch = pytest.importorskip("torch")
    from crossgait.importing import stated, torch_files

    file, _ = published.checkpoint(tmp_path / "model_10.pt", published.ENV_YAML_OBSERVATIONS)
    (tmp_path / "agent.yaml").write_text("policy: {activation: elu}\n")
    agent = stated.of_yaml(str(tmp_path / "agent.yaml"))
    plain = torch_files.read_checkpoint(file, agent)
    saved = torch.load(file)
    state = saved["model_state_dict"]
    state["actor.0.weight"] = torch.nn.Parameter(state["actor.0.weight"])  # that gradients are asked of
    state["actor.0.bias"] = torch._neg_view(-state["actor.0.bias"].double())  # whose sign is a mark
    torch.save(saved, file)
    for layer, expected in zip(
        torch_files.read_checkpoint(file, agent).network.layers, plain.network.layers, strict=True
    ):
        assert all(map(np.array_equal, layer, expected))
    state["actor.0.weight"] = state["actor.0.weight"].to("meta")
    torch.save(saved, file)
    with pytest.raises(ConfigError, match=r"actor\.0\.weight: expected a tensor of numbers"):
        torch_files.read_checkpoint(file, stated.of_yaml(str(tmp_path / "agent.yaml")))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "memory_a.rnn.weight_hh_l0",
            None,
            r"weight_hh_l0: expected a tensor of numbers with 2 dimensions, found none",
        ),
        ("memory_a.rnn.weight_hh_l0", "text", r"weight_hh_l0: expected a tensor of numbers.*found str"),
        ("memory_a.rnn.bias_hh_l0", [3], r"memory_a\.rnn\.\*: expected weights of 1 layers of lstm, 8 wide"),
        ("memory_a.rnn.weight_ih_l0", [0, 0], r"memory_a\.rnn\.\*: expected weights of 1 layers of lstm, 8 wide"),
        ("actor_obs_normalizer._std", [1, 7], r"normaliser: expected \d+ of each, found \d+ means and 7 deviations"),
        (
            "actor.0.weight",
            [2],
            r"actor\.0\.weight: expected a tensor of numbers with 2 dimensions, found 1 dimensions",
        ),
        ("memory_a.rnn.bias_ih_l0", math.nan, r"bias_ih_l0: expected finite numbers, found others among them"),
        ("actor.0.bias", None, r"actor\.0\.bias: expected a tensor of numbers with 1 dimensions, found none"),
    ],
)
def test_checkpoints_of_other_tensors_are_refused(tmp_path, name, value, message):
    torch = pytest.importorskip("torch")
    from crossgait.importing import stated, torch_files

    file, _ = published.checkpoint(tmp_path / "model_10.pt", published.ENV_YAML_OBSERVATIONS, recurrent=True)
    saved = torch.load(file)
    saved["model_state_dict"].pop(name)
    if value is not None:
        given = torch.full([32], value) if isinstance(value, float) else value
        saved["model_state_dict"][name] = torch.zeros(given) if isinstance(given, list) else given
    torch.save(saved, file)
    (tmp_path / "agent.yaml").write_text("policy: {activation: elu, rnn_type: lstm}\n")
    with pytest.raises(ConfigError, match=message):
        torch_files.read_checkpoint(file, stated.of_yaml(str(tmp_path / "agent.yaml")))


@pytest.mark.parametrize(
    "bytes_",
    [
        b"",
        b"PK",
        # Of a name that says it is UTF-8, and is none; of a version of ZIP that there is not.
        b"PK\x01\x02"
        + bytes(4)
        + b"\x00\x08"
        + bytes(18)
        + b"\x01\x00"
        + bytes(16)
        + b"\xc0"
        + b"PK\x05\x06"
        + bytes(6)
        + b"\x01\x00"
        + b"/\x00\x00\x00"
        + bytes(6),
        b"PK\x01\x02"
        + b"\x00\x00\xff\xff"
        + bytes(20)
        + b"\x01\x00"
        + bytes(16)
        + b"a"
        + b"PK\x05\x06"
        + bytes(6)
        + b"\x01\x00"
        + b"/\x00\x00\x00"
        + bytes(6),
    ],
)
def test_zips_that_are_none_are_refused(tmp_path, bytes_):
    torch_files = pytest.importorskip("crossgait.importing.torch_files")
    file = tmp_path / "model.pt"
    file.write_bytes(bytes_)
    with pytest.raises(ConfigError, match=r"model\.pt: file: expected a file of PyTorch's"):
        torch_files.is_script(str(file))


def test_legged_gym_of_other_sizes_wants_the_observation(tmp_path):
    network = published.actor(45)
    file = published.export_script(network, tmp_path / "policy.pt")
    config = published.legged_gym(tmp_path / "small_config.py", 45)
    with pytest.raises(ConfigError, match=r"num_observations: expected 48 or 235"):
        crossgait.import_policy(file, ROBOT, tmp_path / "walk", config)
    terms = [
        {"block": "base_angular_velocity_local", "scale": 0.25},
        "gravity",
        "command",
        "joint_offsets",
        {"block": "joint_velocities", "scale": 0.05},
        "last_action",
    ]
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", config, settings={"observation": terms})
    act_like(imported, network)


def test_rl_sar(tmp_path):
    network = published.Mixture(3 * OBSERVATIONS)
    file = published.export_script(network, tmp_path / "policy.pt")
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", published.rl_sar(tmp_path / "config.yaml"))
    act_like(imported, network)
    fields = by_field(imported)
    assert fields["joints.order"].value == list(JOINTS)
    assert fields["joints.limit"].value == 50
    assert (fields["history.by"].value, fields["history.order"].value) == ("frame", "newest_first")
    names = crossgait.Policy.load(imported.folder, imported.environment_file).layout.observation.names
    assert names[0] == "command.vx"
    assert names[OBSERVATIONS] == "command.vx@0.02"


def test_torchscript_that_remembers(tmp_path):
    network = published.Remembering(3 * OBSERVATIONS)
    file = published.export_script(network, tmp_path / "policy.pt")
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", published.rl_sar(tmp_path / "config.yaml"))
    act_like(imported, published.Remembering(3 * OBSERVATIONS))


def test_history_in_frames_is_what_was_seen(tmp_path):
    config = crossgait.EnvironmentConfig.from_dict(
        {
            "robot": ROBOT,
            "action": "joints",
            "policy_dt": 0.02,
            "observation": [{"block": b, "history": 3} for b in ("gravity", "joint_offsets")],
            "history": {"by": "frame", "order": "oldest_first", "before": "zeros"},
        }
    )
    policy = crossgait.Policy.load("zero", config)
    assert policy.layout.observation.names[:3] == ("gravity_B.x@0.04", "gravity_B.y@0.04", "gravity_B.z@0.04")
    assert policy.layout.observation.names[15:18] == ("gravity_B.x@0.02", "gravity_B.y@0.02", "gravity_B.z@0.02")


def test_two_do_not_write_one_folder(tmp_path, deployed):
    _, file, deploy = deployed
    folder = tmp_path / "walk"
    folder.mkdir()
    held = os.open(folder, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    with pytest.raises(ConfigError, match="folder: expected one writer at a time"):
        crossgait.import_policy(file, ROBOT, folder, deploy)
    assert not list(folder.iterdir())
    os.close(held)
    assert crossgait.import_policy(file, ROBOT, folder, deploy).policy == str(folder / "walk.yaml")


def test_an_import_replaces_all_of_another(tmp_path, deployed):
    _, file, deploy = deployed
    folder = tmp_path / "walk"
    crossgait.import_policy(file, ROBOT, folder, deploy)
    (folder / "walk.safetensors").write_bytes(b"of another form")
    before = {each.name: each.read_bytes() for each in folder.iterdir()}
    held = os.open(folder / "environment.yaml", os.O_RDWR)
    fcntl.flock(held, fcntl.LOCK_EX)
    with pytest.raises(ConfigError, match="a file that nobody is writing"):
        crossgait.import_policy(file, ROBOT, folder, deploy)
    os.close(held)
    (folder / "deploy.yaml").write_text("unknown: 1\n")
    with pytest.raises(ConfigError):
        crossgait.import_policy(file, ROBOT, folder, folder / "deploy.yaml")
    (folder / "deploy.yaml").unlink()
    assert {each.name: each.read_bytes() for each in folder.iterdir()} == before
    crossgait.import_policy(file, ROBOT, folder, deploy)
    assert {each.name for each in folder.iterdir()} == set(before) - {"walk.safetensors"}


def test_an_import_takes_the_place_of_nothing_else(tmp_path, deployed):
    _, file, deploy = deployed
    folder = tmp_path / "walker"
    folder.mkdir()
    (folder / "walker.safetensors").write_text("mine")
    with pytest.raises(ConfigError, match=r"a new one, or that of an earlier import.*found walker\.safetensors"):
        crossgait.import_policy(file, ROBOT, folder, deploy)
    assert [each.name for each in folder.iterdir()] == ["walker.safetensors"]
    (folder / "walker.safetensors").unlink()
    (tmp_path / "victim").write_text("mine")
    (folder / "import.json").symlink_to(tmp_path / "victim")
    with pytest.raises(ConfigError, match=r"import\.json: expected a file of an import's own, found a link"):
        crossgait.import_policy(file, ROBOT, folder, deploy)
    assert (tmp_path / "victim").read_text() == "mine"


def test_settings_are_fields_and_of_their_kind(tmp_path, deployed):
    _, file, deploy = deployed
    for settings, message in (
        ({"servos.kdd": 1}, r"settings: servos\.kdd: expected one of the keys .*did you mean servos\.kd"),
        ({"nope": 3}, r"settings: nope: expected one of the keys"),
        ({"servos.kd": "a"}, r"settings: servos\.kd: expected a finite number, found 'a'"),
        ({"servos.kd": {"FL_nose": 1}}, r"settings: servos\.kd: expected one of the keys"),
    ):
        with pytest.raises(ConfigError, match=message):
            crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy, settings=settings)
    imported = crossgait.import_policy(file, ROBOT, tmp_path / "walk", deploy, settings={"servos.kd": {"FL_knee": 2}})
    assert crossgait.rollout(imported, episodes=1).to_frame()["steps"].iloc[0] > 0  # it stands for its folder


def test_the_command_writes_json(tmp_path, deployed):
    _, file, deploy = deployed
    command = [
        sys.executable,
        "-m",
        "crossgait.importing",
        file,
        "--from",
        deploy,
        "--robot",
        ROBOT,
        "--out",
        str(tmp_path / "walk"),
        "--document",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    document = json.loads(done.stdout)["document"]
    assert document["environment_file"] == str(tmp_path / "walk" / "environment.yaml")
    assert {"name", "value", "source"} == set(document["fields"][0])
    assert document["unstated"]
    assert document["environment"]["policy_dt"] == 0.02
    assert os.path.exists(document["policy"])
    broken = subprocess.run([*command[:3], os.devnull, *command[4:]], capture_output=True, text=True, check=False)
    assert broken.returncode == 2
