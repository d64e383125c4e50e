"""Valid files of every kind that crossgait reads, and the command that reads each. For bombs and fuzz-readers."""
import json
import os
import shutil
import struct
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.path.join(ROOT, "build", "release", "apps", "crossgait")

# What reads a file of a kind; {} is the file. Short, so that the reading is most of it.
COMMANDS = {
    "robot.urdf": ["robots", "{}"],
    "robot.yaml": ["robots", "{}"],
    "robot.xml": ["robots", "{}"],
    "bars.xml": ["robots", "{}"],
    "robot.sdf": ["robots", "{}"],
    "env.yaml": ["env", "--config", "{}"],
    "scripted.yaml": ["rollout", "--policy", "{}", "--episodes", "1", "--episode-seconds", ".02"],
    "hierarchical.yaml": ["rollout", "--policy", "{}", "--episodes", "1", "--episode-seconds", ".02"],
    "policy.safetensors": ["rollout", "--policy", "{}", "--episodes", "1", "--episode-seconds", ".02"],
    "trace.csv": ["report", "{}", "--out", "page.html"],
    "verdict.json": ["report", "{}", "--out", "page.html"],
    "map.csv": ["terrain", "{}"],
    "map.png": ["terrain", "{}"],
    "scene.sdf": ["terrain", "{}", "--cell", ".1"],
    "ground.bin": ["terrain", "{folder}/ground.xml", "--cell", ".1"],
    "bench.json": ["bench", "--from", "{}"],
    "runs.jsonl": ["verdict", "--runs", "{}", "--seconds", ".1", "--settle", ".1", "--starts", "4"],
}


def legs_on_bars():
    """An MJCF whose knees are turned by a crank on the thigh and a rod; frames, ellipsoids, sites that are connected."""
    legs = loops = ""
    for name, x, y in [("FL", 0.2, 0.1), ("FR", 0.2, -0.1), ("RL", -0.2, 0.1), ("RR", -0.2, -0.1)]:
        legs += (f"<frame pos='{x} {y} 0' euler='0 0 0'><body name='{name}_thigh'><joint name='{name}_hip'/><geom fromto='0 0 0 0 0 -.2'/>"
                 f"<body name='{name}_shin' pos='0 0 -.2'><joint name='{name}_knee'/><geom fromto='0 0 0 0 0 -.2'/>"
                 f"<site name='{name}_a' pos='-.03 0 .03'/></body>"
                 f"<body name='{name}_crank' pos='0 0 -.02'><joint name='{name}_crank'/><geom fromto='0 0 0 -.03 0 .03'/>"
                 f"<body name='{name}_rod' pos='-.03 0 .03'><joint name='{name}_rod'/><geom fromto='0 0 0 0 0 -.18'/>"
                 f"<site name='{name}_b' pos='0 0 -.18'/></body></body></body></frame>")
        loops += (f"<connect site1='{name}_b' site2='{name}_a'/>" if x > 0 else
                  f"<connect body1='{name}_rod' body2='{name}_shin' anchor='0 0 -.18' solref='.005 1'/>")
    return ("<mujoco><compiler angle='radian'/><default><joint axis='0 1 0' range='-2.4 2.4'/><geom type='capsule' size='.008'/>"
            "</default><worldbody><body name='trunk'><freejoint/><geom type='ellipsoid' size='.2 .1 .04'/>"
            f"{legs}</body></worldbody><equality>{loops}</equality></mujoco>")


def command_of(program, kind, file):
    """The command line that reads `file` as a file of `kind`."""
    return [program] + [file if word == "{}" else word.replace("{folder}", os.path.dirname(file))
                        for word in COMMANDS[kind]]


def run(program, arguments):
    """Standard output of a command that must succeed."""
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def run_in(folder, command):
    """Runs a command, which must succeed, where its outputs may lie."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: a valid file is refused: {done.stderr}")


def safetensors(tensors, metadata):
    """Bytes of a file of {name: (shape, floats)}."""
    header, data = {"__metadata__": metadata}, b""
    for name, (shape, values) in tensors.items():
        bytes_ = struct.pack(f"<{len(values)}f", *values)
        header[name] = {"dtype": "F32", "shape": shape, "data_offsets": [len(data), len(data) + len(bytes_)]}
        data += bytes_
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + data


def policy(env):
    """A bundle for the environment that is described so, whose network says zero whatever it sees."""
    observation, action = ([entry["name"] for entry in env[key]] for key in ("observation", "action"))
    inputs, outputs = len(observation), len(action)
    metadata = {"format": "crossgait-policy-1", "activation": "tanh", "output": "tanh",
                "layout_version": str(env["layout_version"]), "layout_hash": env["layout_hash"],
                "observation_names": json.dumps(observation), "action_names": json.dumps(action),
                "policy_dt": str(env["policy_dt"])}
    return safetensors({"layer.0.weight": ([outputs, inputs], [0.0] * inputs * outputs),
                        "layer.0.bias": ([outputs], [0.0] * outputs),
                        "golden.observation": ([1, inputs], [0.5] * inputs),
                        "golden.action": ([1, outputs], [0.0] * outputs)}, metadata)


def make_valid(program, folder):
    """Writes one file of every kind into `folder`, the repository's own where it has one, and sees that each is read."""
    env = json.loads(run(program, ["env", "--describe", "--json", "-"]))
    version = env["layout_version"]

    def models(*parts):
        return os.path.join(ROOT, "models", *parts)

    for name in ("robot.urdf", "robot.yaml"):
        shutil.copy(models("robots", "scara_quadruped", name), folder)
    shutil.copy(os.path.join(ROOT, "tests", "physics", "robot_files", "sdf", "yard_dog.sdf"),
                os.path.join(folder, "robot.sdf"))
    # With what it includes in it: one file to change.
    mjcf = os.path.join(ROOT, "tests", "backends", "mjcf")
    with open(os.path.join(mjcf, "serial_quadruped.xml"), encoding="utf-8") as file:
        text = file.read()
    with open(os.path.join(mjcf, "legs.xml"), encoding="utf-8") as file:
        legs = file.read().replace("<mujocoinclude>", "").replace("</mujocoinclude>", "")
    with open(os.path.join(folder, "robot.xml"), "w", encoding="utf-8") as file:
        file.write(text.replace('<include file="legs.xml"/>', legs))
    shutil.copy(models("terrains", "blocks.csv"), os.path.join(folder, "map.csv"))
    shutil.copy(models("terrains", "bumps.png"), os.path.join(folder, "map.png"))
    shutil.copy(os.path.join(ROOT, "benchmarks", "results", "amd-epyc-2-cores.json"),
                os.path.join(folder, "bench.json"))
    with open(os.path.join(folder, "ground.bin"), "wb") as file:  # a height field of MuJoCo's
        file.write(struct.pack("=2i4f", 2, 2, 0, 1, 2, 3))
    texts = {
        "bars.xml": legs_on_bars(),
        "ground.xml": "<mujoco><asset><hfield name='h' file='ground.bin' size='1 1 .1 .1'/></asset>"
        "<worldbody><geom type='hfield' hfield='h'/></worldbody></mujoco>",
        "scene.sdf": "<sdf version='1.9'><world name='w'><model name='m'><static>1</static><link name='l'>"
        "<collision name='c'><geometry><heightmap><uri>map.png</uri><size>2 2 .1</size></heightmap></geometry>"
        "</collision></link></model></world></sdf>",
        "env.yaml": run(program, ["env", "--yaml", "--terrain", "rough"])
        + "randomisation: {friction: [.5, 1], mass: [.9, 1.1], terrain_seed: [0, 9]}\n",
        "joints.yaml": "action: joints\nrobot: serial_quadruped\nsettle_seconds: 0\nobservation: [{block: gravity, history: 2},"
        " {block: clock_sin, history: 2}, {block: height_scan, history: 2}]\n"
        "history: {by: frame, order: oldest_first, before: first}\nclock: {frequency: 2, phases: [0, .5]}\n"
        "height_scan: {x: [-.1, .1], y: [0, .1], offset: .3, x_first: true}\n"
        "start: {height: .3, velocity: [.1, 0, 0], angular_velocity: [0, 0, .1]}\n",
        "scripted.yaml": f"kind: scripted\nlayout_version: {version}\nsteps:\n"
        "  - {time: 0, action: {residual.FL.z: .5}}\n  - {time: .01, parameters: {step_height: .05}}\n",
        "hierarchical.yaml": f"kind: hierarchical\nlayout_version: {version}\n"
        "planner: {policy: zero, observation: [p_WB., param.], dt: .1}\nresidual: {policy: random}\n",
    }
    for name, text in texts.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    with open(os.path.join(folder, "policy.safetensors"), "wb") as file:
        file.write(policy(env))
    run(program, ["walk", "--seconds", ".2", "--settle", ".1", "--trace", os.path.join(folder, "trace.csv")])
    run(program, ["verdict", "--seconds", ".1", "--settle", ".1", "--starts", "4", "--explain",
                  "--json", os.path.join(folder, "verdict.json")])
    runs = os.path.join(folder, "runs.jsonl")
    run(program, [word if word != "{}" else runs for word in COMMANDS["runs.jsonl"]])
    for kind in COMMANDS:
        run_in(folder, command_of(program, kind, os.path.join(folder, kind)))
