// Sliders and choices of a live page. What they show is what the server says; what they are moved to is sent.
import { button, digits, h, scroller } from "./dom";
import type { Command, LiveFrame, LiveOptions, LiveQuantity, LiveRobot } from "./live_link";
import { LivePlot } from "./live_plot";
import type { Driver } from "./live_drive";
import { theme } from "./theme";

const DEGREES = 180 / Math.PI;

interface Range {
  name: string;
  label: string;
  unit: string;
  help: string;
  min: number;
  max: number;
}

/** After a pointer, the keys are the robot's again; who came by keyboard stays. */
function leave(element: HTMLElement): void {
  if (!element.matches(":focus-visible")) element.blur();
}

/** A slider with its number and unit. */
class Slider {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly output = h("output");
  private moved = -Infinity;

  constructor(
    private readonly range: Range,
    change: (value: number) => void,
  ) {
    const { name, label, unit, help, min, max } = range;
    this.input = h("input", {
      type: "range",
      name,
      min,
      max,
      step: (max - min) / 200,
      title: help,
      "aria-label": unit === "-" ? label : `${label}, ${unit}`,
      input: () => {
        this.moved = performance.now();
        this.say(Number(this.input.value));
        change(Number(this.input.value));
      },
      change: () => leave(this.input),
    });
    this.element = h("div", { class: "slider" }, h("span", { title: help }, label), this.input, this.output);
  }
  set disabled(on: boolean) {
    this.input.disabled = on;
  }
  /** Unless a hand is, or was just now, on it. */
  show(value: number): void {
    if (this.input.matches(":active") || performance.now() - this.moved < 400) return;
    this.input.value = String(value);
    this.say(value);
  }
  private say(value: number): void {
    this.output.textContent = `${digits(value)}${this.range.unit === "-" ? "" : ` ${this.range.unit}`}`;
  }
}

/** The last name of a path. */
const fileName = (path: string) => path.replace(/.*\//, "");

/** Names, and the one that there is, if it is a file. */
function withFile(names: string[], there: string): string[] {
  return there === "" || names.includes(there) ? names : [there, ...names];
}

/** @param shown  what stands for a value; itself by default */
function options(
  names: [string, string][],
  label: string,
  change: (value: string) => void,
  shown = (value: string) => value,
): HTMLSelectElement {
  const select: HTMLSelectElement = h(
    "select",
    { "aria-label": label, change: () => (leave(select), change(select.value)) },
    ...names.map(([value, help]) => h("option", { value, title: help }, shown(value))),
  );
  return select;
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return h("section", { class: "group live-group" }, h("h2", {}, title), ...children);
}

/** What a robot does, in numbers. */
class Readout {
  readonly element = h("tr");
  private readonly cells = Array.from({ length: 8 }, () => h("td"));
  private readonly lamps = ["FL", "FR", "RL", "RR"].map((leg) => h("i", { class: "lamp", title: `foot ${leg}` }, leg));
  private readonly name = h("th", { scope: "row" });
  private smooth: number[] | null = null;

  constructor(private readonly index: number) {
    this.element.append(this.name, ...this.cells, h("td", {}, ...this.lamps));
  }
  show(robot: LiveRobot): void {
    // Velocities of a body in its stride, over half a second.
    this.smooth = robot.velocity.map((v, i) => (this.smooth?.[i] ?? v) * 0.96 + 0.04 * v);
    const said = robot.outcome === "walked" ? "upright" : robot.outcome.replace("_", " ");
    const texts = [
      said,
      ...this.smooth.map((v) => v.toFixed(2)),
      (1000 * robot.height).toFixed(0),
      (DEGREES * robot.roll).toFixed(1),
      (DEGREES * robot.pitch).toFixed(1),
      this.index === 0 ? "" : (1000 * robot.gap).toFixed(1),
    ];
    this.name.textContent = robot.engine;
    this.element.style.setProperty("--colour", theme.runColour(this.index));
    this.cells.forEach(
      (cell, i) => (cell.textContent = (texts[i] ?? "").replace(/^-(?=0\.?0*$)/, "").replace("-", "\u2212")),
    );
    this.lamps.forEach((lamp, i) => {
      lamp.classList.toggle("down", robot.contact[i]);
      lamp.classList.toggle("swing", robot.swing[i]);
    });
  }
}

/** The world's quantities by sliders: those that are moved away from what they were at first are changes. */
class World {
  readonly element: HTMLElement;
  private readonly sliders: Slider[];
  private readonly values: number[];

  constructor(
    private readonly known: LiveQuantity[],
    private readonly change: (changes: string[]) => void,
  ) {
    this.values = known.map((q) => q.value);
    this.sliders = known.map(
      (q, i) =>
        new Slider({ ...q, label: q.name.replaceAll("_", " ") }, (value) => {
          this.values[i] = value;
          this.change(this.changes());
        }),
    );
    const reset: HTMLButtonElement = button("as at first", "as at first: the world", () => this.change([]));
    this.element = section("World", ...this.sliders.map((slider) => slider.element), h("div", { class: "row" }, reset));
  }
  show(changes: string[]): void {
    const said = new Map(changes.map((change) => change.split("=") as [string, string]));
    this.known.forEach((q, i) => {
      const text = said.get(q.name);
      this.values[i] = text === undefined ? q.value : Number(text.replace("x", ""));
      this.sliders[i]!.show(this.values[i]);
    });
  }
  private changes(): string[] {
    return this.known.flatMap((q, i) =>
      this.values[i] === q.value ? [] : [`${q.name}=${q.factor ? "x" : ""}${this.values[i]}`],
    );
  }
}

export class Controls {
  readonly element: HTMLElement;
  private readonly plot: LivePlot;
  private readonly world: World;
  private readonly drive: [keyof LiveFrame["command"], Slider][];
  private readonly parameters: Slider[];
  private readonly gait: HTMLSelectElement;
  private readonly curve: HTMLSelectElement;
  private readonly engines: HTMLSelectElement[];
  private readonly robot: HTMLSelectElement;
  private readonly policy: HTMLSelectElement;
  private readonly terrain: HTMLSelectElement;
  private readonly seed: HTMLInputElement;
  private readonly settings: HTMLInputElement;
  private readonly readouts: Readout[] = [];
  private readonly rows = h("tbody");
  private terrainShown = "";

  constructor(
    private readonly known: LiveOptions,
    driver: Driver,
    private readonly send: (command: Command) => void,
  ) {
    const { limits } = known;
    const velocity = (
      name: keyof LiveFrame["command"],
      label: string,
      unit: string,
      most: number,
    ): [typeof name, Slider] => [
      name,
      new Slider({ name, label, unit, help: label, min: -most, max: most }, (value) => driver.set({ [name]: value })),
    ];
    this.drive = [
      velocity("vx", "forward", "m/s", limits.forward),
      velocity("vy", "left", "m/s", limits.left),
      velocity("yaw_rate", "turn left", "rad/s", limits.yaw_rate),
    ];
    this.parameters = known.parameters.map(
      (p) =>
        new Slider({ ...p, label: p.name.replaceAll("_", " ") }, (value) => send({ do: "set", name: p.name, value })),
    );
    this.gait = options(
      known.gaits.map((g) => [g.name, g.summary]),
      "Gait",
      (gait) => send({ do: "gait", gait }),
    );
    this.curve = options(
      known.curves.map((curve) => [curve, "The path of a foot through the air"]),
      "Swing curve",
      (curve) => send({ do: "curve", curve }),
    );
    this.engines = Array.from({ length: known.most_engines }, (_, i) =>
      options(
        [
          ...(i > 0 ? ([["none", ""]] as [string, string][]) : []),
          ...known.engines.map((e): [string, string] => [e, ""]),
        ],
        i > 0 ? `Engine beside it, ${i}` : "Engine",
        () => this.chooseEngines(),
      ),
    );
    this.robot = options(
      withFile(known.robots, known.robot).map((name) => [name, "Driven by hand"]),
      "Robot",
      (robot) => send({ do: "robot", robot }),
      fileName,
    );
    this.robot.value = known.robot;
    this.policy = options(
      [
        ["", "A hand alone drives"],
        ...withFile(known.policies, known.policy ?? "").map((name): [string, string] => [name, "In its environment"]),
      ],
      "Policy",
      (policy) => send({ do: "policy", policy }),
      (policy) => fileName(policy) || "none",
    );
    this.policy.value = known.policy ?? "";
    this.terrain = options(
      known.terrains.map((t) => [t.name, t.help]),
      "Ground",
      () => {
        this.settings.value = "";
        this.changeGround();
      },
    );
    this.settings = h("input", {
      type: "text",
      placeholder: "key=value,...",
      "aria-label": "Parameters of the ground",
      title: "As behind the colon of --terrain, e.g. rise=.01,run=.1",
      change: () => this.changeGround(),
    });
    this.seed = h("input", {
      type: "number",
      min: 0,
      step: 1,
      value: 0,
      "aria-label": "Seed of the ground",
      title: "Seed",
      change: () => this.changeGround(),
    });
    this.plot = new LivePlot(known);
    this.world = new World(known.quantities, (changes) => send({ do: "change", changes }));
    // A policy has its own mind about the gait: sliders show what it does.
    if (known.policy !== null)
      for (const control of [this.gait, this.curve, ...this.parameters]) control.disabled = true;
    // Nothing is known of values before the first frame.
    this.element = h("div", { class: "controls", style: "visibility: hidden" }, this.numbers(), ...this.groups());
  }

  show(frame: LiveFrame): void {
    this.element.style.visibility = "";
    for (const [name, slider] of this.drive) slider.show(frame.command[name]);
    frame.parameters?.forEach((value, i) => this.parameters[i]!.show(value));
    const show = (select: HTMLSelectElement, value: string) => {
      if (document.activeElement !== select && select.value !== value) select.value = value;
    };
    if (frame.chosen) show(this.gait, frame.chosen);
    if (frame.curve) show(this.curve, frame.curve);
    this.engines.forEach((select, i) => show(select, frame.robots[i]?.engine ?? "none"));
    const ground = `${frame.terrain} ${frame.seed}`;
    if (ground !== this.terrainShown) {
      const [name, ...settings] = frame.terrain.split(":");
      this.terrain.value = name!;
      this.settings.value = settings.join(":");
      this.seed.value = String(frame.seed);
      this.terrainShown = ground;
    }
    while (this.readouts.length < frame.robots.length) this.readouts.push(new Readout(this.readouts.length));
    this.readouts.length = frame.robots.length;
    if (this.rows.childElementCount !== this.readouts.length)
      this.rows.replaceChildren(...this.readouts.map((r) => r.element));
    this.readouts.forEach((readout, i) => readout.show(frame.robots[i]!));
    this.world.show(frame.changes);
    this.plot.add(frame);
  }

  private chooseEngines(): void {
    const engines = this.engines.map((select) => select.value).filter((name) => name !== "none");
    this.send({ do: "engines", engines });
  }
  private changeGround(): void {
    const settings = this.settings.value.trim();
    this.send({
      do: "terrain",
      terrain: settings ? `${this.terrain.value}:${settings}` : this.terrain.value,
      seed: Math.max(0, Math.round(Number(this.seed.value) || 0)),
    });
  }
  private numbers(): HTMLElement {
    const heads = [
      "engine",
      "state",
      "forward, m/s",
      "left, m/s",
      "turn, rad/s",
      "height, mm",
      "roll, \u00b0",
      "pitch, \u00b0",
      "gap, mm",
      "feet",
    ];
    return scroller(
      "What the robots do",
      h(
        "table",
        { class: "readout" },
        h("thead", {}, h("tr", {}, ...heads.map((head) => h("th", { scope: "col" }, head)))),
        this.rows,
      ),
    );
  }
  private groups(): HTMLElement[] {
    const height = this.known.parameters.findIndex((p) => p.name === "body_height");
    const others = this.parameters.filter((_, i) => i !== height);
    return [
      section("Drive", ...this.drive.map(([, slider]) => slider.element)),
      section(
        "Robot",
        h("div", { class: "row" }, this.robot, h("label", {}, "policy", this.policy)),
        h(
          "p",
          { class: "muted" },
          "or drop a robot's file on this page, a folder with its meshes, or a policy with its environment.yaml",
        ),
      ),
      section(
        "Engine",
        h(
          "div",
          { class: "row" },
          this.engines[0]!,
          h("span", { class: "muted" }, "beside it"),
          ...this.engines.slice(1),
        ),
      ),
      section("Over time", this.plot.element),
      this.world.element,
      section("Ground", h("div", { class: "row" }, this.terrain, this.settings, h("label", {}, "seed", this.seed))),
      section(
        "Gait",
        h("div", { class: "row" }, this.gait, h("label", {}, "swing", this.curve)),
        ...[this.parameters[height]!, ...others].map((slider) => slider.element),
      ),
    ];
  }
}
