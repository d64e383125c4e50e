"""Policies from PyTorch modules."""

from __future__ import annotations

import io
import re
import warnings

import numpy as np
import pytest

import crossgait
from crossgait.policies import Policy

torch = pytest.importorskip("torch")

from policy_models import ACTIONS, JOINTS, OBSERVATIONS, random_normalisation  # noqa: E402
from torch import nn  # noqa: E402

MEAN, STD = random_normalisation()


@pytest.fixture(autouse=True)
def one_thread():
    torch.set_num_threads(1)
    torch.manual_seed(4)


def sequential(activation=nn.ELU, *end):
    return nn.Sequential(
        nn.Linear(OBSERVATIONS, 20), activation(), nn.Linear(20, 16), activation(), nn.Linear(16, ACTIONS), *end
    )


class Normalised(nn.Module):
    """As rsl_rl and its like export: statistics in buffers, then an actor."""

    def __init__(self, actor=None, clip=5.0, eps=1e-2):
        super().__init__()
        self.register_buffer("mean", torch.tensor(MEAN[None], dtype=torch.float32))
        self.register_buffer("std", torch.tensor(STD[None], dtype=torch.float32))
        self.eps = eps
        self.clip = clip
        self.actor = actor or sequential()

    def forward(self, x):
        x = torch.clamp((x - self.mean) / (self.std + self.eps), -self.clip, self.clip)
        return self.actor(x)


class TwoHeads(nn.Module):
    def __init__(self):
        super().__init__()
        self.body = nn.Sequential(nn.Linear(OBSERVATIONS, 2 * ACTIONS))

    def forward(self, x):
        mean, log_std = self.body(x).chunk(2, dim=-1)
        return torch.tanh(mean), log_std.exp()


def layers_of(module):
    linear = [m for m in module.modules() if isinstance(m, nn.Linear)]
    return [(m.weight.detach().double().numpy(), m.bias.detach().double().numpy()) for m in linear]


def scripted(module, how="script"):
    """As a file is written and read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        made = torch.jit.script(module) if how == "script" else torch.jit.trace(module, torch.zeros(1, OBSERVATIONS))
        file = io.BytesIO()
        torch.jit.save(made, file)
        file.seek(0)
        return torch.jit.load(file)


@pytest.mark.parametrize(
    ("kind", "activation"), [(nn.Tanh, "tanh"), (nn.ELU, "elu"), (nn.ReLU, "relu"), (nn.SiLU, "swish")]
)
@pytest.mark.parametrize("end", [(), (nn.Tanh(),)])
def test_sequential_modules(kind, activation, end):
    module = sequential(kind, *end)
    policy = Policy.from_torch(module, JOINTS)
    network = policy.network
    assert (network.activation, network.output) == (activation, "tanh" if end else "linear")
    for layer, expected in zip(network.layers, layers_of(module), strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(layer, expected, strict=True))
    observation = np.random.default_rng(0).normal(0, 1, OBSERVATIONS).astype(np.float32)
    with torch.no_grad():
        theirs = module(torch.from_numpy(observation)).numpy()
    # Single precision, summed in another order.
    np.testing.assert_allclose(policy.act(observation), np.clip(theirs, -1, 1), atol=2e-6)


def test_golden_actions_are_the_modules():
    module = sequential()
    bundle = Policy.from_torch(module, JOINTS).bundle
    with torch.no_grad():
        rows = [module(torch.from_numpy(row[None]).float())[0].numpy() for row in bundle.golden_observation]
    assert np.array_equal(bundle.golden_action, np.clip(rows, -1, 1).astype(np.float64))
    assert np.ptp(bundle.golden_action) > 0.05


@pytest.mark.parametrize("how", [None, "script", "trace"])
def test_normalisation_inside_the_module(tmp_path, how):
    module = Normalised().eval()
    policy = Policy.from_torch(scripted(module, how) if how else module, JOINTS)
    network = policy.network
    # The sum is of single precision in the module.
    np.testing.assert_allclose(network.normalisation, (MEAN, STD + 1e-2), rtol=1e-6)
    assert network.clip == 5
    assert np.array_equal(network.layers[0][0], layers_of(module)[0][0])
    policy.save(tmp_path / "p.safetensors")
    observation = np.linspace(-3, 3, OBSERVATIONS)
    assert np.array_equal(Policy.load(tmp_path / "p.safetensors", JOINTS).act(observation), policy.act(observation))


@pytest.mark.parametrize("how", ["script", "trace"])
def test_torchscript_files(tmp_path, how):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        module = sequential(nn.SiLU)
        made = torch.jit.script(module) if how == "script" else torch.jit.trace(module, torch.zeros(1, OBSERVATIONS))
        torch.jit.save(made, tmp_path / "policy.pt")
    policy = Policy.from_torch(tmp_path / "policy.pt", JOINTS)
    assert policy.name == "policy.pt"
    assert policy.network.activation == "swish"
    (tmp_path / "bad.pt").write_bytes(b"nothing of the kind")
    with pytest.raises(crossgait.ConfigError, match="TorchScript"):
        Policy.from_torch(tmp_path / "bad.pt", JOINTS)


def test_normalisation_outside_the_module():
    module = sequential()
    network = Policy.from_torch(module, JOINTS, normalisation=(MEAN, STD), clip=4).network
    assert np.array_equal(network.normalisation, (MEAN, STD))
    assert network.clip == 4


@pytest.mark.parametrize("how", [None, "script"])
def test_one_of_several_outputs(how):
    module = scripted(TwoHeads()) if how else TwoHeads()
    network = Policy.from_torch(module, JOINTS, output=0).network
    assert network.output == "tanh"
    assert network.layers[0][0].shape == (ACTIONS, OBSERVATIONS)
    with pytest.raises(crossgait.ConfigError, match=r"which of several"):
        Policy.from_torch(module, JOINTS)
    with pytest.raises(crossgait.ConfigError, match="an index of 2 outputs"):
        Policy.from_torch(module, JOINTS, output=2)


def test_the_forward_pass_counts_and_not_what_is_registered():
    class Reversed(nn.Module):
        def __init__(self):
            super().__init__()
            self.second, self.first = nn.Linear(8, ACTIONS), nn.Linear(OBSERVATIONS, 8)
            self.unused = nn.LSTM(3, 3)

        def forward(self, x):
            y = nn.functional.silu(self.first(x * 0.5))
            return torch.tanh(self.second(y) * torch.tensor(2.0))

    module = Reversed()
    network = Policy.from_torch(module, JOINTS).network
    assert [w.shape for w, _ in network.layers] == [(8, OBSERVATIONS), (ACTIONS, 8)]
    assert np.array_equal(network.normalisation[1], np.full(OBSERVATIONS, 2.0))
    np.testing.assert_array_equal(network.layers[1][0], 2 * layers_of(module)[0][0])


def test_in_place_activations_and_dropout_in_training_mode():
    module = nn.Sequential(
        nn.Flatten(), nn.Linear(OBSERVATIONS, 8), nn.ELU(inplace=True), nn.Dropout(0.5), nn.Linear(8, ACTIONS)
    ).train()
    assert Policy.from_torch(module, JOINTS).network.activation == "elu"
    assert module.training
    assert Policy.from_torch(scripted(module), JOINTS).network.activation == "elu"


def test_modules_in_double_and_half_precision():
    module = sequential().double()
    weight = Policy.from_torch(module, JOINTS).network.layers[0][0]
    assert np.array_equal(weight, layers_of(module)[0][0].astype(np.float32))
    module = sequential().half()
    weight = Policy.from_torch(module, JOINTS).network.layers[0][0]
    assert np.array_equal(weight, layers_of(module)[0][0])


class Recurrent(nn.Module):
    def __init__(self):
        super().__init__()
        self.memory = nn.LSTM(OBSERVATIONS, ACTIONS)

    def forward(self, x):
        return self.memory(x)[0]


class Skipping(nn.Module):
    def __init__(self):
        super().__init__()
        self.first = nn.Linear(OBSERVATIONS, ACTIONS)

    def forward(self, x):
        y = self.first(x)
        return y + torch.tanh(y)


class Deciding(nn.Module):
    def __init__(self):
        super().__init__()
        self.a, self.b = nn.Linear(OBSERVATIONS, ACTIONS), nn.Linear(OBSERVATIONS, ACTIONS)

    def forward(self, x):
        if bool(x.sum() > 0):
            return self.a(x)
        return self.b(x)


def with_nan():
    module = sequential()
    with torch.no_grad():
        module[2].weight[1, 2] = torch.nan
    return module


REFUSED = [
    (Recurrent, "forward: .*layer 'memory' .LSTM. has", "layer 'memory' .LSTM. has"),
    (
        lambda: nn.Sequential(nn.Unflatten(1, (1, OBSERVATIONS)), nn.Conv1d(1, 1, 37), nn.Flatten()),
        "layer '[01]' .(Conv1d|Unflatten).",
        "aten::(conv1d|unflatten|view)",
    ),
    (lambda: sequential(nn.GELU), "layer '1' .GELU.: .*aten::gelu", "aten::gelu"),
    (lambda: sequential(nn.LeakyReLU), "layer '1' .LeakyReLU.", "aten::leaky_relu"),
    (lambda: sequential(lambda: nn.ELU(alpha=0.5)), "layer '1' .ELU.: expected alpha 1, found 0.5", "alpha 1"),
    (lambda: sequential(nn.Sigmoid), "layer '3' .Sigmoid.: expected tanh, elu", "found sigmoid"),
    (
        lambda: sequential(lambda: nn.LayerNorm(20 if not counted() else 16)),
        "layer '1' .LayerNorm.",
        "aten::layer_norm",
    ),
    (
        lambda: sequential(nn.ELU, nn.Hardtanh(-0.5, 0.5)),
        "layer '5' .Hardtanh.: expected limits as wide",
        "limits as wide",
    ),
    (
        lambda: nn.Sequential(*sequential()[:3], nn.Tanh(), *sequential()[4:]),
        "layer '1' .ELU.: .*found elu and tanh",
        "elu",
    ),
    (Skipping, "forward of Skipping: .*skip connection", "skip connection"),
    (Deciding, "forward: expected a pass that torch.export follows", "if bool"),
    (with_nan, r"layer '2' .Linear.: expected finite numbers, found nan at \[1, 2\]", "finite numbers"),
]
_COUNT = iter(range(100))


def counted():
    return next(_COUNT) % 2


@pytest.mark.parametrize(("make", "words", "script_words"), REFUSED)
def test_what_no_bundle_can_say_is_refused_by_its_layer(make, words, script_words):
    module = make()
    with pytest.raises(crossgait.ConfigError) as caught:
        Policy.from_torch(module, JOINTS)
    assert re.search(words, str(caught.value)), caught.value
    with pytest.raises(crossgait.ConfigError) as caught:
        Policy.from_torch(scripted(module), JOINTS)
    assert re.search(script_words, str(caught.value)), caught.value


def test_modules_of_another_size():
    with pytest.raises(crossgait.ConfigError, match=r"torch\.export"):
        Policy.from_torch(nn.Linear(OBSERVATIONS + 1, ACTIONS), JOINTS)
    with pytest.raises(crossgait.ConfigError, match="weights for 48 inputs"):
        Policy.from_torch(scripted(nn.Sequential(nn.Linear(OBSERVATIONS + 1, ACTIONS))), JOINTS)
    with pytest.raises(crossgait.ConfigError, match="expected 12 actions, found 14, the last 2 after target"):
        Policy.from_torch(nn.Linear(OBSERVATIONS, 14), JOINTS)


def test_what_the_exporter_of_pytorch_writes(tmp_path):
    """Through ONNX and directly, the network is the same."""
    pytest.importorskip("onnxruntime")
    module = Normalised(sequential(nn.SiLU, nn.Tanh())).eval()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter of TorchScript, which needs nothing more, is deprecated
        torch.onnx.export(
            module,
            (torch.zeros(1, OBSERVATIONS),),
            str(tmp_path / "p.onnx"),
            dynamo=False,
            input_names=["obs"],
            output_names=["actions"],
            dynamic_axes={"obs": {0: "batch"}},
        )
    a, b = Policy.from_onnx(tmp_path / "p.onnx", JOINTS).network, Policy.from_torch(module, JOINTS).network
    assert (a.activation, a.output, a.clip) == (b.activation, b.output, b.clip) == ("swish", "tanh", 5)
    for layer, other in zip(a.layers, b.layers, strict=True):
        assert all(np.array_equal(x, y) for x, y in zip(layer, other, strict=True))
    np.testing.assert_allclose(a.normalisation, b.normalisation, rtol=1e-7)  # folded by either in single precision


def test_torchscript_takes_consent(tmp_path, monkeypatch):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        torch.jit.save(torch.jit.script(nn.Linear(OBSERVATIONS, ACTIONS)), tmp_path / "policy.pt")
    monkeypatch.delenv("CROSSGAIT_TRUST")
    with pytest.raises(crossgait.ConfigError, match="PyTorch's interpreter runs TorchScript"):
        Policy.from_torch(tmp_path / "policy.pt", JOINTS)
