"""One reader of the Python package under Atheris: python_fuzz_target.py TARGET [options of libFuzzer] CORPUS SEEDS.

What is no result and no ConfigError is a finding; so are 20 s, 2 GB and a signal. With --replay FOLDER every file there is read once,
without Atheris, for the lines that are reached. Seeds are valid files (`--seeds FOLDER`)."""
import contextlib
import os
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python" / "tests"))
REPLAY = "--replay" in sys.argv or "--seeds" in sys.argv
instrumented = contextlib.nullcontext()
if not REPLAY:
    import atheris

    instrumented = atheris.instrument_imports(include=["crossgait"])
with instrumented:
    import crossgait
    from crossgait.importing import environment, forms, imported

from crossgait import ConfigError, EnvironmentConfig  # noqa: E402
from crossgait._core import PolicyInterface  # noqa: E402
from crossgait.importing.contract import Contract  # noqa: E402
from crossgait.inputs import as_environment  # noqa: E402
from crossgait.policies import onnx_reader  # noqa: E402
from crossgait.policies.policy import _seen  # noqa: E402
from crossgait.sweep import strict_yaml  # noqa: E402
from crossgait.sweep.study import Study  # noqa: E402
from crossgait.train.plan import Plan  # noqa: E402

ROBOT = crossgait.Robot.load("serial_quadruped")
INTERFACE = PolicyInterface(as_environment("serial_joints"))
FOLDER = pathlib.Path(tempfile.mkdtemp(prefix="crossgait-fuzz-"))


def stated(name):
    """What an import reads of a file, but for the network."""

    def read(data):
        file = FOLDER / name
        file.write_bytes(data)
        contract = Contract(ROBOT)
        roots, _ = imported._read_files([str(file)], None)
        for root in roots:
            forms.find_form(root).read(root, contract, forms.Options(None, (str(FOLDER),)))
            root.unread()
        imported._require(contract, str(file))
        EnvironmentConfig.parse(environment.to_text(environment.make_environment(contract, "serial_quadruped")), "made")

    return read


def onnx(data):
    file = FOLDER / "policy.onnx"
    file.write_bytes(data)
    onnx_reader.read(str(file), INTERFACE, _seen(INTERFACE, None, None), None)


def checkpoint(data):
    from crossgait.importing import stated as statements
    from crossgait.importing import torch_files

    file = FOLDER / "model.pt"
    file.write_bytes(data)
    agent = FOLDER / "agent.yaml"
    agent.write_text("policy: {activation: elu, rnn_type: lstm}\n")
    if not torch_files.is_script(str(file)):
        torch_files.read_checkpoint(str(file), statements.of_yaml(str(agent)))


def yaml(data):
    document = strict_yaml.parse_yaml(data.decode("utf-8", "replace"), "a.yaml")
    strict_yaml.parse_yaml(strict_yaml.write_yaml(document), "written")


def study(data):
    file = FOLDER / "study.yaml"
    file.write_bytes(data)
    Study.load(str(file))


def plan(data):
    file = FOLDER / "plan.yaml"
    file.write_bytes(data)
    Plan.load(str(file))


TARGETS = {
    "deploy": stated("deploy.yaml"), "env": stated("env.yaml"), "rl_sar": stated("config.yaml"), "legged_gym": stated("config.py"),
    "onnx": onnx, "checkpoint": checkpoint, "yaml": yaml, "study": study, "plan": plan,
}


def make_seeds(folder):
    """Valid files of every target, in FOLDER/TARGET/."""
    import published_policies as published

    for name in TARGETS:
        (folder / name).mkdir(parents=True)
    for history in (1, 5):
        published.deploy_yaml(folder / f"deploy/{history}.yaml", history)
    (folder / "env/env.yaml").write_text(published.ENV_YAML)
    (folder / "env/net.yaml").write_text(published.ENV_YAML.replace("actuator_pd:DCMotor", "actuator_net:ActuatorNetMLP"))
    published.rl_sar(folder / "rl_sar/config.yaml")
    for observations in (48, 235):
        published.legged_gym(folder / f"legged_gym/{observations}.py", observations)
    published.export_onnx(published.actor(45), folder / "onnx/a.onnx", 45)
    published.export_onnx(published.actor(45), folder / "onnx/b.onnx", 45, published.mjlab_metadata())
    for recurrent in (False, True):
        published.checkpoint(folder / f"checkpoint/{recurrent}.pt", 45, recurrent)
    (folder / "yaml/a.yaml").write_text("a: &x [1, 2.5e3, true, null, 'text', {b: c}]\nd: |\n  lines\ne: 0x1f\n")
    (folder / "study/a.yaml").write_text("walks:\n  - {gait: [trot, walk], speed: [0.1, 0.2]}\nengines: [mujoco]\nstarts: 2\n")
    for preset in pathlib.Path(crossgait.__file__).parent.glob("train/presets/*.yaml"):
        (folder / "plan" / preset.name).write_text(preset.read_text())


def once(read, data):
    with contextlib.suppress(ConfigError):
        read(data)


def main():
    if sys.argv[1] == "--seeds":
        return make_seeds(pathlib.Path(sys.argv[2]))
    read = TARGETS[sys.argv.pop(1)]
    if REPLAY:
        for file in sorted(pathlib.Path(sys.argv[2]).glob("*")):
            once(read, file.read_bytes())
        return None
    atheris.Setup(sys.argv, lambda data: once(read, data))
    atheris.Fuzz()
    return None


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
