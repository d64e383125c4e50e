"""Policies from ONNX files and to them."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import numpy as np
import pytest

import crossgait
from crossgait.policies import MlpNetwork, Policy

onnx = pytest.importorskip("onnx")
onnxruntime = pytest.importorskip("onnxruntime")

from policy_models import (  # noqa: E402
    ACTIONS,
    JOINTS,
    OBSERVATIONS,
    OnnxFile,
    random_layers,
    random_network,
    random_normalisation,
)

from crossgait.policies.onnx_budget import MOST_BYTES, MOST_NODES, MOST_NUMBERS  # noqa: E402

FLOAT, HALF, DOUBLE = onnx.TensorProto.FLOAT, onnx.TensorProto.FLOAT16, onnx.TensorProto.DOUBLE


def single(numbers):
    return np.asarray(numbers, dtype=np.float32)


def playground(path, *, hidden=(24, 16), deviation=True):
    """As Brax and MuJoCo Playground export through tf2onnx, opset 11.

    (x - mean) / std as nodes, MatMul and Add per layer with weights [in, out], swish as
    x * Sigmoid(beta x) with beta 1, Split of mean and deviation, Tanh. Returns the layers,
    without those of the deviation.
    """
    file = OnnxFile()
    mean, std = random_normalisation()
    layers = random_layers([OBSERVATIONS, *hidden, 2 * ACTIONS if deviation else ACTIONS])
    file.node("Sub", ["obs", file.constant("mean", single(mean))], "sub")
    x = file.node("Div", ["sub", file.constant("std", single(std))], "normalised")
    file.constant("beta", single(1))
    for k, (weight, bias) in enumerate(layers):
        file.node("MatMul", [x, file.constant(f"hidden_{k}/kernel", single(weight.T))], f"hidden_{k}/MatMul")
        x = file.node("Add", [f"hidden_{k}/MatMul", file.constant(f"hidden_{k}/bias", single(bias))], f"hidden_{k}")
        if k + 1 < len(layers):
            file.node("Mul", [x, "beta"], f"swish_{k}/mul")
            file.node("Sigmoid", [f"swish_{k}/mul"], f"swish_{k}/Sigmoid")
            x = file.node("Mul", [x, f"swish_{k}/Sigmoid"], f"swish_{k}")
    if deviation:
        x = file.node("Split", [x], ["loc", "scale"], axis=-1, split=[ACTIONS, ACTIONS])[0]
    file.node("Tanh", [x], "action")
    file.write(path, opset=11)
    return [*layers[:-1], (layers[-1][0][:ACTIONS], layers[-1][1][:ACTIONS])]


def test_a_playground_export_is_read_to_the_last_bit(tmp_path):
    layers = playground(tmp_path / "p.onnx")
    policy = Policy.from_onnx(tmp_path / "p.onnx", JOINTS)
    network = policy.network
    assert (network.activation, network.output, network.clip) == ("swish", "tanh", None)
    assert np.array_equal(network.normalisation, random_normalisation())
    for (weight, bias), (expected_weight, expected_bias) in zip(network.layers, layers, strict=True):
        assert np.array_equal(weight, expected_weight)
        assert np.array_equal(bias, expected_bias)
    observation = np.random.default_rng(2).normal(0, 1, OBSERVATIONS)
    session = onnxruntime.InferenceSession(tmp_path / "p.onnx", providers=["CPUExecutionProvider"])
    theirs = session.run(None, {"obs": single(observation)[None]})[0][0]
    # Single precision, summed in another order.
    np.testing.assert_allclose(policy.act(single(observation)), theirs, atol=2e-6)


def test_golden_actions_are_those_of_onnxruntime(tmp_path):
    playground(tmp_path / "p.onnx")
    bundle = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).bundle
    session = onnxruntime.InferenceSession(tmp_path / "p.onnx", providers=["CPUExecutionProvider"])
    rows = [session.run(None, {"obs": single(row)[None]})[0][0] for row in bundle.golden_observation]
    assert np.array_equal(bundle.golden_action, np.array(rows, dtype=np.float64))
    assert np.ptp(bundle.golden_action) > 0.1


def test_a_joint_policy_runs_by_a_bundle_and_a_yaml_alone(tmp_path):
    playground(tmp_path / "p.onnx")
    (tmp_path / "env.yaml").write_text(JOINTS.to_yaml(), encoding="utf-8")
    Policy.from_onnx(tmp_path / "p.onnx", tmp_path / "env.yaml").save(tmp_path / "p.safetensors")
    command = [sys.executable, "-m", "crossgait", "rollout", "--policy", "p.safetensors", "--config", "env.yaml"]
    engine = crossgait.available_engines()[0]
    done = subprocess.run(
        [*command, "--episodes", "1", "--episode-seconds", "1", "--engine", engine],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "p.safetensors" in done.stdout


def test_given_observations_become_golden_ones(tmp_path):
    playground(tmp_path / "p.onnx")
    observations = np.random.default_rng(1).normal(0, 1, (300, OBSERVATIONS)).astype(np.float32)
    golden = Policy.from_onnx(tmp_path / "p.onnx", JOINTS, observations=observations).bundle.golden_observation
    assert len(golden) == 256
    assert np.array_equal(golden[[0, -1]], observations[[0, -1]])
    for wrong, words in ((observations[:, 1:], r"\[n, 48\]"), (observations * np.nan, "finite")):
        with pytest.raises(crossgait.ConfigError, match=words):
            Policy.from_onnx(tmp_path / "p.onnx", JOINTS, observations=wrong)


def test_normalisation_outside_the_file(tmp_path):
    file = OnnxFile()
    ((weight, bias),) = random_layers([OBSERVATIONS, ACTIONS])
    file.node("Gemm", ["obs", file.constant("w", single(weight)), file.constant("b", single(bias))], "action", transB=1)
    file.write(tmp_path / "p.onnx")
    mean, std = random_normalisation()
    policy = Policy.from_onnx(tmp_path / "p.onnx", JOINTS, normalisation=(mean, std), clip=2)
    observation = mean + 3 * std * np.where(np.arange(OBSERVATIONS) % 2, 1, 0.1)
    expected = weight @ np.where(np.arange(OBSERVATIONS) % 2, 2, 0.3) + bias
    np.testing.assert_allclose(policy.act(observation), np.clip(expected, -1, 1), atol=2e-6)  # single precision
    with pytest.raises(crossgait.ConfigError, match=r"std of .*: expected a number above zero"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS, normalisation=(mean, 0 * std))
    with pytest.raises(crossgait.ConfigError, match="48 finite numbers"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS, normalisation=(mean[1:], std))


# One layer's spellings: each adds nodes from "obs" to "action"; the network is weight, bias, and what it returns.

WEIGHT, BIAS = random_layers([OBSERVATIONS, ACTIONS], seed=8)[0]
MEAN, STD = random_normalisation()


def dense(file, x="obs", output="action", weight=WEIGHT, bias=BIAS, kind=np.float32):
    names = [file.constant(f"{output}/w", weight.astype(kind)), file.constant(f"{output}/b", bias.astype(kind))]
    return file.node("Gemm", [x, *names], output, transB=1)


def spell_scaled_gemm(file):
    weight, bias = file.constant("w", single(WEIGHT.T / 2)), file.constant("b", single(BIAS[None] * 4))
    file.node("Gemm", ["obs", weight, bias], "action", alpha=2.0, beta=0.25)


def spell_transposed(file):
    file.node("Transpose", [file.constant("w", single(WEIGHT))], "wt", perm=[1, 0])
    file.node("MatMul", ["obs", "wt"], "y")
    file.node("Add", [file.constant("b", single(BIAS[None])), "y"], "action")


def spell_constant_nodes(file):
    for name, numbers in (("w", WEIGHT), ("b", BIAS)):
        file.node("Constant", [], name, value=onnx.numpy_helper.from_array(single(numbers)))
    file.node("Constant", [], "one", value_float=1.0)
    file.node("Gemm", ["obs", "w", "b"], "y", transB=1)
    file.node("Mul", ["one", "y"], "action")


def spell_shapes(file):
    file.node("Identity", ["obs"], "a")
    file.node("Unsqueeze", ["a", file.constant("zero", np.array([0]))], "b")
    file.node("Squeeze", ["b", "zero"], "c")
    file.node("Shape", ["c"], "shape")
    file.node("Gather", ["shape", file.constant("batch", np.array(0))], "n")
    file.node("Unsqueeze", ["n", "zero"], "n1")
    file.node("Concat", ["n1", file.constant("rest", np.array([-1]))], "to", axis=0)
    file.node("Reshape", ["c", "to"], "d")
    file.node("Flatten", ["d"], "e", axis=1)
    file.node("Dropout", ["e"], "f")
    file.node("Cast", ["f"], "g", to=FLOAT)
    dense(file, "g")


def spell_slices(file):
    long = np.vstack([WEIGHT[::-1], WEIGHT])
    dense(file, output="y", weight=long, bias=np.concatenate([BIAS[::-1], BIAS]))
    limits = [file.constant(n, np.array([v])) for n, v in (("start", ACTIONS), ("end", 2**62), ("axis", 1))]
    file.node("Slice", ["y", *limits], "action")


def spell_gather(file):
    order = np.random.default_rng(4).permutation(ACTIONS)
    dense(file, output="y", weight=WEIGHT[order], bias=BIAS[order])
    file.node("Gather", ["y", file.constant("back", np.argsort(order))], "action", axis=-1)


def spell_concat(file):
    half = ACTIONS // 2
    dense(file, output="left", weight=WEIGHT[:half], bias=BIAS[:half])
    dense(file, output="right", weight=WEIGHT[half:], bias=BIAS[half:])
    file.node("Concat", ["left", "right"], "action", axis=1)


def spell_arithmetic(file):
    dense(file, output="y", weight=-2 * WEIGHT, bias=BIAS * 0)
    file.node("Neg", ["y"], "z")
    file.node("Div", ["z", file.constant("two", single(2))], "half")
    file.node("Sub", [file.constant("b", single(BIAS)), "half"], "m")
    file.node("Sub", ["m", file.constant("b2", single(2 * BIAS))], "n")
    file.node("Neg", ["n"], "action")


def spell_two_linear_layers(file):
    rng = np.random.default_rng(9)
    turn, _ = np.linalg.qr(rng.normal(size=(ACTIONS, ACTIONS)))
    dense(file, output="y", weight=turn.T @ WEIGHT, bias=BIAS * 0)
    dense(file, "y", weight=turn)


def spell_output_limits(file):
    dense(file, output="y")
    file.node("Clip", ["y", file.constant("low", single(-1)), file.constant("high", single(1))], "action")


@pytest.mark.parametrize(
    "spell", [f for name, f in list(globals().items()) if name.startswith("spell_")], ids=lambda f: f.__name__[6:]
)
def test_spellings_of_one_layer(tmp_path, spell):
    file = OnnxFile()
    spell(file)
    file.write(tmp_path / "p.onnx")
    network = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network
    ((weight, bias),) = network.layers
    # Products and quotients of single precision.
    np.testing.assert_allclose(weight, WEIGHT, rtol=0, atol=3e-7)
    np.testing.assert_allclose(bias, BIAS, rtol=0, atol=3e-7)
    assert network.normalisation is None
    assert network.clip is None


def normalise_folded(file):
    scale = file.constant("scale", single(1 / STD))
    file.node("Mul", ["obs", scale], "scaled")
    return file.node("Add", ["scaled", file.constant("shift", single(-MEAN / STD))], "seen")


def normalise_variance(file):
    """As EmpiricalNormalization: (x - mean) / (std + eps), with the statistics of a running variance."""
    file.node("Sqrt", [file.constant("var", single(STD**2))], "std")
    file.node("Add", ["std", file.constant("eps", single([[1e-2]]))], "divisor")
    file.node("Sub", ["obs", file.constant("mean", single(MEAN[None]))], "centred")
    return file.node("Div", ["centred", "divisor"], "seen")


def normalise_clipped(file):
    file.node("Sub", ["obs", file.constant("mean", single(MEAN))], "centred")
    file.node("Div", ["centred", file.constant("std", single(STD))], "normalised")
    return file.node("Clip", ["normalised", file.constant("low", single(-3)), file.constant("high", single(3))], "seen")


def normalise_batch(file):
    names = [
        file.constant(n, single(v))
        for n, v in (("g", np.ones(48)), ("s", np.zeros(48)), ("mean", MEAN), ("var", STD**2))
    ]
    return file.node("BatchNormalization", ["obs", *names], "seen", epsilon=1e-5)


@pytest.mark.parametrize(
    ("normalise", "std", "clip"),
    [
        (normalise_folded, STD, None),
        (normalise_variance, STD + 1e-2, None),
        (normalise_clipped, STD, 3),
        (normalise_batch, np.sqrt(STD**2 + 1e-5), None),
    ],
)
def test_spellings_of_normalisation(tmp_path, normalise, std, clip):
    file = OnnxFile()
    dense(file, normalise(file))
    file.write(tmp_path / "p.onnx")
    network = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network
    # Reciprocals and squares of single precision.
    np.testing.assert_allclose(network.normalisation, (MEAN, std), rtol=1e-6, atol=1e-6)
    assert network.clip == clip
    assert np.array_equal(network.layers[0][0], WEIGHT)


def swish_of_sigmoid(file, x):
    return file.node("Mul", [file.node("Sigmoid", [x], "gate"), x], "h")


@pytest.mark.parametrize(
    ("nodes", "activation"),
    [
        (lambda file, x: file.node("Tanh", [x], "h"), "tanh"),
        (lambda file, x: file.node("Elu", [x], "h", alpha=1.0), "elu"),
        (lambda file, x: file.node("Relu", [x], "h"), "relu"),
        (lambda file, x: file.node("Max", [x, file.constant("zero", single(0))], "h"), "relu"),
        (lambda file, x: file.node("Clip", [x, file.constant("zero", single(0))], "h"), "relu"),
        (swish_of_sigmoid, "swish"),
    ],
)
@pytest.mark.parametrize("final", [True, False])
def test_spellings_of_activations(tmp_path, nodes, activation, final):
    file = OnnxFile()
    first, second = random_layers([OBSERVATIONS, 9, ACTIONS])
    dense(file, output="y", weight=first[0], bias=first[1])
    dense(file, nodes(file, "y"), "raw" if final else "action", *second)
    if final:
        file.node("Tanh", ["raw"], "action")
    file.write(tmp_path / "p.onnx")
    network = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network
    assert (network.activation, network.output) == (activation, "tanh" if final else "linear")
    assert np.array_equal(network.layers[0][0], first[0])


@pytest.mark.parametrize("opset", [7, 9, 11, 13, 18])
def test_opsets(tmp_path, opset):
    """Clip's limits became inputs in 11, Split's sizes in 13, num_outputs came in 18."""
    file = OnnxFile()
    limits = {"min": -3.0, "max": 3.0} if opset < 11 else {}
    inputs = [] if limits else [file.constant("low", single(-3)), file.constant("high", single(3))]
    file.node("Clip", ["obs", *inputs], "seen", **limits)
    dense(file, "seen", "both", np.vstack([WEIGHT, -WEIGHT]), np.concatenate([BIAS, BIAS]))
    sizes = {"split": [ACTIONS, ACTIONS]} if opset < 13 else {"num_outputs": 2} if opset >= 18 else {}
    more = [file.constant("sizes", np.array([ACTIONS, ACTIONS]))] if not sizes else []
    file.node("Split", ["both", *more], ["action", "deviation"], axis=1, **sizes)
    file.write(tmp_path / "p.onnx", opset=opset)
    network = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network
    assert network.clip == 3
    assert np.array_equal(network.layers[0][0], WEIGHT)


@pytest.mark.parametrize(("element", "kind"), [(FLOAT, np.float32), (DOUBLE, np.float64), (HALF, np.float16)])
@pytest.mark.parametrize(("rank", "batch"), [(2, 1), (2, "batch"), (3, 1)])
def test_types_and_batches(tmp_path, element, kind, rank, batch):
    file = OnnxFile()
    if rank == 3:
        file.node("MatMul", ["obs", file.constant("w", WEIGHT.T.astype(kind))], "y")
        file.node("Add", ["y", file.constant("b", BIAS.astype(kind))], "action")
    else:
        dense(file, kind=kind)
    file.write(tmp_path / "p.onnx", element=element, rank=rank, batch=batch)
    ((weight, _),) = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network.layers
    assert np.array_equal(weight, WEIGHT.astype(kind).astype(np.float32))


def test_an_input_without_a_batch(tmp_path):
    file = OnnxFile()
    file.node("MatMul", [file.constant("w", single(WEIGHT)), "obs"], "action")
    file.write(tmp_path / "p.onnx", rank=1)
    ((weight, bias),) = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network.layers
    assert np.array_equal(weight, WEIGHT)
    assert not bias.any()


def test_half_weights_of_a_single_precision_network(tmp_path):
    file = OnnxFile()
    file.constant("half", WEIGHT.astype(np.float16))
    file.node("Cast", ["half"], "w", to=FLOAT)
    file.node("Gemm", ["obs", "w", file.constant("b", single(BIAS))], "action", transB=1)
    file.write(tmp_path / "p.onnx")
    ((weight, _),) = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network.layers
    assert np.array_equal(weight, WEIGHT.astype(np.float16))


def test_one_of_several_outputs(tmp_path):
    file = OnnxFile()
    dense(file, output="mean")
    dense(file, output="log_std", bias=BIAS + 1)
    outputs = {"mean": ACTIONS, "log_std": ACTIONS}
    file.write(tmp_path / "p.onnx", outputs=outputs)
    ((_, bias),) = Policy.from_onnx(tmp_path / "p.onnx", JOINTS, output="mean").network.layers
    assert np.array_equal(bias, BIAS)
    with pytest.raises(crossgait.ConfigError, match="which of several, found mean, log_std"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)
    with pytest.raises(crossgait.ConfigError, match="one named 'std', found mean, log_std"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS, output="std")


# What no bundle can say.


def refuse_lstm(file):
    rng = np.random.default_rng(0)
    file.node("Unsqueeze", ["obs", file.constant("zero", np.array([0]))], "sequence")
    names = [file.constant(n, single(rng.normal(size=(1, 4 * ACTIONS, s)))) for n, s in (("w", 48), ("r", ACTIONS))]
    file.node("LSTM", ["sequence", *names], ["", "memory"], hidden_size=ACTIONS)
    file.node("Squeeze", ["memory", "zero"], "action")


def refuse_convolution(file):
    file.node("Unsqueeze", ["obs", file.constant("one", np.array([1]))], "image")
    file.node("Conv", ["image", file.constant("w", single(np.ones((1, 1, 37))))], "filtered")
    file.node("Squeeze", ["filtered", "one"], "action")


def refuse_normalisation_of_layers(file):
    dense(file, output="y")
    ones = file.constant("ones", single(np.ones(ACTIONS)))
    file.node("LayerNormalization", ["y", ones], "action")


def refuse_softplus(file):
    file.node("Softplus", [dense(file, output="y")], "h")
    dense(file, "h", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_lonely_sigmoid(file):
    file.node("Sigmoid", [dense(file, output="y")], "h")
    dense(file, "h", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_leaky(file):
    file.node("LeakyRelu", [dense(file, output="y")], "h")
    dense(file, "h", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_other_elu(file):
    file.node("Elu", [dense(file, output="y")], "h", alpha=0.5)
    dense(file, "h", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_mixed_activations(file):
    file.node("Tanh", [dense(file, output="y")], "t")
    dense(file, "t", "z", np.eye(ACTIONS), BIAS)
    file.node("Relu", ["z"], "r")
    dense(file, "r", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_skip_connection(file):
    file.node("Tanh", [dense(file, output="y")], "t")
    file.node("Add", ["t", "y"], "action")


def refuse_product_of_layers(file):
    file.node("Mul", [dense(file, output="y"), dense(file, output="z", bias=BIAS + 1)], "action")


def refuse_steeper_swish(file):
    """X times sigmoid(2 x)."""
    dense(file, output="y")
    file.node("Mul", ["y", file.constant("two", single(2))], "steep")
    file.node("Sigmoid", ["steep"], "gate")
    dense(file, file.node("Mul", ["y", "gate"], "h"), weight=np.eye(ACTIONS), bias=BIAS)


def refuse_narrow_limits(file):
    dense(file, output="y")
    file.node("Clip", ["y", file.constant("low", single(-0.5)), file.constant("high", single(1))], "action")


def refuse_uneven_clip(file):
    file.node("Clip", ["obs", file.constant("low", single(-1)), file.constant("high", single(2))], "seen")
    dense(file, "seen")


def refuse_hidden_limits(file):
    dense(file, output="y")
    file.node("Clip", ["y", file.constant("low", single(-1)), file.constant("high", single(1))], "h")
    dense(file, "h", weight=np.eye(ACTIONS), bias=BIAS)


def refuse_scaled_output(file):
    file.node("Relu", [dense(file, output="y")], "r")
    dense(file, "r", "z", np.eye(ACTIONS), BIAS)
    file.node("Tanh", ["z"], "t")
    file.node("Mul", ["t", file.constant("scale", single(0.5))], "action")


def refuse_nan(file):
    weight = WEIGHT.copy()
    weight[3, 4] = np.nan
    dense(file, weight=weight)


def refuse_zero_divisor(file):
    std = STD.copy()
    std[7] = 0
    file.node("Div", ["obs", file.constant("std", single(std))], "seen")
    dense(file, "seen")


def refuse_noise(file):
    dense(file, output="y")
    file.node("RandomNormal", [], "noise", shape=[1, ACTIONS], scale=1e-7)
    file.node("Add", ["y", "noise"], "action")


def refuse_transposed_batch(file):
    file.node("Transpose", ["obs"], "turned", perm=[1, 0])
    file.node("Reshape", ["turned", file.constant("to", np.array([1, 48]))], "back")
    dense(file, "back")


def refuse_constant_output(file):
    file.node("Identity", [file.constant("c", single(BIAS[None]))], "action")


@pytest.mark.parametrize(
    ("spell", "words"),
    [
        (refuse_lstm, r"node 'LSTM_\w*' \(LSTM\): expected an operation of a multilayer perceptron.*found LSTM"),
        (refuse_convolution, "node 'Conv_filtered'"),
        (refuse_normalisation_of_layers, "node 'LayerNormalization_action'"),
        (refuse_softplus, "node 'Softplus_h'"),
        (refuse_lonely_sigmoid, "node 'Sigmoid_h'.*expected tanh, elu, relu, swish.*found sigmoid"),
        (refuse_leaky, "node 'LeakyRelu_h'"),
        (refuse_other_elu, r"node 'Elu_h' \(Elu\): expected alpha 1, found 0.5"),
        (refuse_mixed_activations, "node 'Tanh_t'.*the same activation everywhere, found tanh and relu"),
        (refuse_skip_connection, "node 'Add_action'.*skip connection"),
        (refuse_product_of_layers, "node 'Mul_action'"),
        (refuse_steeper_swish, r"node 'Mul_h' \(Mul\): expected x times sigmoid\(x\), which is swish"),
        (refuse_narrow_limits, "node 'Clip_action'.*limits as wide as those of .*, -1 to 1, found -0.5 to 1"),
        (refuse_uneven_clip, "node 'Clip_seen'.*the same up and down"),
        (refuse_hidden_limits, "node 'Clip_h'.*found clip"),
        (refuse_scaled_output, "node 'Relu_r'.*found relu and tanh"),
        (refuse_nan, r"node 'Gemm_action'.*finite numbers, found nan at \[3, 4\]"),
        (refuse_zero_divisor, "node 'Div_seen'.*found 0 at 7"),
        (refuse_noise, "node 'RandomNormal_noise'"),
        (refuse_transposed_batch, "node 'Transpose_turned'"),
        (refuse_constant_output, "output 'action': expected what depends on the observation"),
    ],
)
def test_what_no_bundle_can_say_is_refused_by_name(tmp_path, spell, words):
    file = OnnxFile()
    spell(file)
    file.write(tmp_path / "p.onnx")
    with pytest.raises(crossgait.ConfigError) as caught:
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)
    assert caught.value.source == str(tmp_path / "p.onnx")
    assert re.search(words, str(caught.value)), caught.value


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"inputs": {"obs": 40}}, "input 'obs': expected 48 observations, found 40, none of which is last.target"),
        ({"inputs": {"obs": 50}}, "found 50, the last 2 after"),
        ({"inputs": {"obs": 48, "h_in": 7}}, "inputs: expected one, the observation; .* found 2: obs, h_in"),
        ({"outputs": {"action": 11}}, "expected 12 actions, found 11, none of which is"),
        ({"batch": 64}, r"a batch of 1 or any size, found \[64, 48\]"),
        ({"element": onnx.TensorProto.INT64}, "floating-point numbers, found INT64"),
    ],
)
def test_inputs_and_outputs_of_another_size(tmp_path, options, words):
    file = OnnxFile()
    inputs, outputs = options.get("inputs", {"obs": 48})["obs"], options.get("outputs", {"action": 12})["action"]
    x = "obs"
    if "element" in options:
        x = file.node("Cast", [x], "float", to=FLOAT)
    dense(file, x, weight=np.resize(WEIGHT, (outputs, inputs)), bias=np.resize(BIAS, outputs))
    if "element" not in options or options["element"] == FLOAT:
        file.write(tmp_path / "p.onnx", **options)
    else:
        tensors = [
            onnx.helper.make_tensor_value_info("obs", options["element"], [1, 48]),
            onnx.helper.make_tensor_value_info("action", FLOAT, [1, 12]),
        ]
        graph = onnx.helper.make_graph(file.nodes, "g", tensors[:1], tensors[1:], file.initialisers)
        onnx.save(onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", 17)]), tmp_path / "p.onnx")
    with pytest.raises(crossgait.ConfigError, match=words):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


def test_files_that_are_no_onnx(tmp_path):
    (tmp_path / "p.onnx").write_bytes(b"nothing of the kind")
    os.mkfifo(tmp_path / "pipe.onnx")
    with (tmp_path / "large.onnx").open("wb") as large:
        large.truncate(MOST_BYTES + 1)
    for path, expected in (
        (tmp_path / "p.onnx", "an ONNX model"),
        (tmp_path / "absent.onnx", "a readable file, found No such file"),
        (tmp_path / "pipe.onnx", "a readable file, found a pipe"),
        ("/dev/zero", "a readable file, found a pipe or device"),
        (tmp_path / "large.onnx", f"at most {MOST_BYTES} bytes"),
    ):
        with pytest.raises(crossgait.ConfigError, match=expected):
            Policy.from_onnx(path, JOINTS)


def test_weights_are_read_in_the_folder_of_the_file_alone(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    weights = np.ones((ACTIONS, OBSERVATIONS), np.float32)
    (tmp_path / "weights").write_bytes(weights.tobytes())
    file = folder / "p.onnx"
    for location in ("weights", "../weights", str(tmp_path / "weights")):
        made = OnnxFile()
        made.node("Gemm", ["obs", made.constant("w", weights)], "action", transB=1)
        made.write(file)
        model = onnx.load(file)
        (initializer,) = model.graph.initializer
        onnx.external_data_helper.set_external_data(initializer, location)
        initializer.ClearField("raw_data")
        file.write_bytes(model.SerializeToString())
        if location == "weights":
            (folder / "weights").write_bytes(weights.tobytes())
            observation = np.linspace(-1, 1, OBSERVATIONS)
            np.testing.assert_allclose(Policy.from_onnx(file, JOINTS).act(observation), observation.sum(), atol=1e-5)
            (folder / "weights").unlink()
            continue
        with pytest.raises(crossgait.ConfigError, match=r"should be file inside|absolute"):
            Policy.from_onnx(file, JOINTS)


@pytest.mark.parametrize(
    ("op", "constants", "attributes"),
    [
        ("ConstantOfShape", [np.array([20000, 20000])], {}),
        ("Expand", [single([1]), np.array([20000, 20000])], {}),
        ("Tile", [single(range(10)), np.array([1000000])], {}),
        ("Range", [np.array(0), np.array(10**9), np.array(1)], {}),
        ("Add", [np.zeros((3000, 1), np.float32), np.zeros((1, 3000), np.float32)], {}),
    ],
)
def test_constants_are_counted_before_they_are_computed(tmp_path, op, constants, attributes):
    """A file of some kilobytes may say how to make gigabytes."""
    file = OnnxFile()
    names = [file.constant(f"c{i}", value) for i, value in enumerate(constants)]
    large = file.node(op, names, "large", **attributes)
    if constants[0].dtype == np.int64:
        large = file.node("Cast", [large], "numbers", to=FLOAT)
    file.node("Add", [dense(file, output="y"), file.node("ReduceSum", [large], "sum", keepdims=0)], "action")
    file.write(tmp_path / "p.onnx", opset=17)
    with pytest.raises(crossgait.ConfigError, match=f"at most {MOST_NUMBERS} numbers in all constants"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


def test_functions_are_counted_before_they_are_unfolded(tmp_path):
    """Each of twenty functions calls the one before it twice."""
    file = OnnxFile()
    dense(file)
    file.write(tmp_path / "p.onnx", opset=17)
    model = onnx.load(tmp_path / "p.onnx")
    opsets = [onnx.helper.make_opsetid("", 17), onnx.helper.make_opsetid("own", 1)]
    for i in range(20):
        called = [
            onnx.helper.make_node("Identity" if i == 0 else f"f{i - 1}", [a], [b], domain="" if i == 0 else "own")
            for a, b in (("x", "y"), ("y", "z"))
        ]
        model.functions.append(onnx.helper.make_function("own", f"f{i}", ["x"], ["z"], called, opsets))
    model.opset_import.append(opsets[1])
    last = model.graph.node[-1]
    last.output[0] = "before"
    model.graph.node.append(onnx.helper.make_node("f19", ["before"], ["action"], domain="own"))
    onnx.save(model, tmp_path / "p.onnx")
    with pytest.raises(crossgait.ConfigError, match=f"at most {MOST_NODES} nodes, with functions unfolded"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


def test_an_initialiser_of_no_known_type(tmp_path):
    file = OnnxFile()
    dense(file)
    file.write(tmp_path / "p.onnx")
    model = onnx.load(tmp_path / "p.onnx")
    model.graph.initializer[0].data_type = 99
    onnx.save(model, tmp_path / "p.onnx")
    with pytest.raises(crossgait.ConfigError):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


@pytest.mark.parametrize(("number", "words"), [(7, "INT64"), (65, "type 65, which ONNX has not")])
def test_an_input_of_no_floating_point_type(tmp_path, number, words):
    file = OnnxFile()
    dense(file)
    file.write(tmp_path / "p.onnx")
    model = onnx.load(tmp_path / "p.onnx")
    model.graph.input[0].type.tensor_type.elem_type = number
    onnx.save(model, tmp_path / "p.onnx")
    with pytest.raises(crossgait.ConfigError, match=f"expected floating-point numbers, found {words}"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


def test_a_network_that_is_read_wrongly_is_refused(tmp_path, monkeypatch):
    """The guard behind the reader: here ELU is taken for tanh."""
    from crossgait.policies import expression

    file = OnnxFile()
    dense(file, file.node("Elu", [dense(file, output="y")], "h"), weight=np.eye(ACTIONS), bias=BIAS)
    file.write(tmp_path / "p.onnx")
    right = expression.activate
    monkeypatch.setattr(expression, "activate", lambda _, value, place: right("tanh", value, place))
    with pytest.raises(crossgait.ConfigError, match=r"what onnxruntime computes, .* the largest difference is 0\.\d+"):
        Policy.from_onnx(tmp_path / "p.onnx", JOINTS)


@pytest.mark.parametrize("activation", ["tanh", "elu", "relu", "swish"])
@pytest.mark.parametrize("output", ["linear", "tanh"])
@pytest.mark.parametrize("clip", [None, 5.0])
def test_a_bundle_is_the_same_after_a_round_trip(tmp_path, activation, output, clip):
    policy = Policy.from_network(random_network(activation, output, clip), JOINTS)
    policy.to_onnx(tmp_path / "p.onnx")
    read = Policy.from_onnx(tmp_path / "p.onnx", JOINTS)
    a, b = policy.network, read.network
    for layer, other in zip(a.layers, b.layers, strict=True):
        assert all(np.array_equal(x, y) for x, y in zip(layer, other, strict=True))
    assert np.array_equal(a.normalisation, b.normalisation)
    assert (a.activation, a.output, a.clip) == (b.activation, b.output, b.clip)


def test_statistics_in_double_precision_survive(tmp_path):
    mean, std = (numbers + 1e-12 for numbers in random_normalisation())
    network = MlpNetwork(random_layers([OBSERVATIONS, ACTIONS]), normalisation=(mean, std), clip=1 / 3)
    Policy.from_network(network, JOINTS).to_onnx(tmp_path / "p.onnx")
    read = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network
    assert np.array_equal(read.normalisation, (mean, std))
    assert read.clip == 1 / 3


def test_what_is_written_acts_as_the_policy_in_any_batch(tmp_path):
    policy = Policy.from_network(random_network(), JOINTS)
    policy.to_onnx(tmp_path / "p.onnx")
    observations = single(np.random.default_rng(6).normal(0, 3, (20, OBSERVATIONS)))
    session = onnxruntime.InferenceSession(tmp_path / "p.onnx", providers=["CPUExecutionProvider"])
    theirs = session.run(["action"], {"observation": observations})[0]
    ours = np.array([policy.act(row) for row in observations])
    np.testing.assert_allclose(theirs, ours, atol=2e-6)  # single precision, summed in another order
    assert np.abs(theirs).max() <= 1


def test_a_file_of_crossgait_is_for_its_environment(tmp_path):
    Policy.from_network(random_network(), JOINTS).to_onnx(tmp_path / "p.onnx")
    yaml = JOINTS.to_yaml()
    slower = crossgait.EnvironmentConfig.parse(yaml.replace("policy_dt: 0.02", "policy_dt: 0.04"))
    with pytest.raises(crossgait.ConfigError, match=r"trained for 0\.02 s"):
        Policy.from_onnx(tmp_path / "p.onnx", slower)
    blocks = "base_linear_velocity_local, base_angular_velocity_local"
    swapped = yaml.replace(blocks, "base_angular_velocity_local, base_linear_velocity_local")
    with pytest.raises(crossgait.ConfigError, match="observation: expected the environment's entries"):
        Policy.from_onnx(tmp_path / "p.onnx", crossgait.EnvironmentConfig.parse(swapped))
    scaled = yaml.replace("scale: 0.5", "scale: 0.4")
    with pytest.raises(crossgait.ConfigError, match=r"layout_hash.*units of some entries differ"):
        Policy.from_onnx(tmp_path / "p.onnx", crossgait.EnvironmentConfig.parse(scaled))


def test_metadata_that_is_not_as_written(tmp_path):
    Policy.from_network(random_network(), JOINTS).to_onnx(tmp_path / "p.onnx")
    for key, value in (("crossgait.action_names", "nothing"), ("crossgait.policy_dt", "soon")):
        model = onnx.load(tmp_path / "p.onnx")
        for entry in model.metadata_props:
            if entry.key == key:
                entry.value = value
        onnx.save(model, tmp_path / "q.onnx")
        with pytest.raises(crossgait.ConfigError, match=r"as Policy\.to_onnx writes it"):
            Policy.from_onnx(tmp_path / "q.onnx", JOINTS)


def test_writing_elsewhere_is_an_error_and_leaves_nothing(tmp_path):
    policy = Policy.from_network(random_network(), JOINTS)
    with pytest.raises(crossgait.ConfigError, match="a place that can be written"):
        policy.to_onnx(tmp_path / "absent" / "p.onnx")
    with pytest.raises(crossgait.ConfigError, match="a policy that is a network"):
        Policy.load("zero", JOINTS).to_onnx(tmp_path / "p.onnx")
    assert not list(tmp_path.iterdir())
