// The live page: the robot as the server simulates it now, and what drives it.
import type { Live, LiveDocument, Motion } from "./document";
import { Numbers } from "./document";
import { button, h, toggle } from "./dom";
import { insideToggles, type Inside } from "./insides";
import { Controls } from "./live_controls";
import { Driver, Pusher } from "./live_drive";
import { droppedFiles } from "./live_drop";
import { Link, type LiveFrame, type LiveOptions, type LiveScene } from "./live_link";
import { LiveRun } from "./live_run";
import { theme } from "./theme";
import { View } from "./view";
import { PRESETS } from "./viewpoint";

const KEYS: [string, string][] = [
  ["\u2191 \u2193", "faster, slower"],
  ["\u2190 \u2192", "turn"],
  ["q e", "step left, right"],
  ["space", "stop"],
  ["i k j l", "push forward, back, left, right"],
  ["p u r", "pause, stand up, record"],
  [". ,", "a step while paused, a second back"],
  ["1 2 3 4", "three-quarter, side, front, top"],
  ["w a s d + \u2212", "turn the view, zoom"],
  ["f b t", "follow, side by side, light or dark"],
];
/** Share of the largest push that a key gives. */
const KEY_PUSH = 0.4;
const GRAVITY = 9.81;
const PACES = [1, 0.5, 0.2, 0.1, 0.05];

/** What walks, and who chose it. */
function gaitOf(frame: LiveFrame): string | null {
  return frame.chosen === frame.gait ? frame.gait : `${frame.chosen}: ${frame.gait}`;
}

const isOn = (label: HTMLElement) => label.querySelector("input")!.checked;

export class LivePage {
  view: View | null = null;
  frame: LiveFrame | null = null;
  options!: LiveOptions;
  private driver!: Driver;
  private controls!: Controls;
  private scene: LiveScene | null = null;
  private fetching = false;
  private readonly insides = new Set<Inside>();
  runs: LiveRun[] = [];
  private shownSubject = 0;
  private pulled = false;
  private shown = ""; // which ground and engines the view was made for
  private readonly link = new Link(
    (frame) => this.show(frame),
    (words) => this.say(words),
  );
  private readonly results = h("div", { class: "results" });
  private readonly holder = h("div", { class: "canvas" });
  private readonly facts = h("p", {}, "connecting");
  private readonly trouble = h("p", { class: "trouble", role: "status" });
  private readonly clock = h("output", { class: "clock" });
  private readonly pause = button("\u275a\u275a", "Pause or go on (p)", () =>
    this.link.send({ do: "pause", on: !this.frame?.paused }),
  );
  private readonly step = button("\u275a\u25b6", "\u275a\u25b6 one control step while paused (.)", () =>
    this.link.send({ do: "step", steps: 1 }),
  );
  private readonly back = button("\u21b6 1 s", "\u21b6 1 s: a second back, of the last minute (,)", () =>
    this.link.send({ do: "back", seconds: Math.min(1, this.frame?.back ?? 0) }),
  );
  private readonly pace: HTMLSelectElement = h(
    "select",
    {
      "aria-label": "Pace: simulated time over time on the clock",
      title: "Slow motion",
      change: () => {
        this.link.send({ do: "pace", pace: Number(this.pace.value) });
        this.pace.blur();
      },
    },
    ...PACES.map((pace) => h("option", { value: pace }, `${pace}\u00d7`)),
  );
  private readonly keep = button(
    "keep the last minute",
    "keep the last minute: it becomes a report that can be saved",
    () => this.link.send({ do: "keep" }),
  );
  private readonly spring = toggle(
    "spring",
    "A spring holds the robot while the pointer is down, in the place of a push",
    false,
    () => {},
  );
  private readonly record = button("\u25cf record", "Record a minute at most (r)", () =>
    this.link.send({ do: "record", on: this.frame?.recorded === null }),
  );
  private readonly save = h(
    "a",
    { href: "report", download: "crossgait-live.html", class: "button", hidden: true },
    "save the report",
  );
  private readonly follow = toggle(
    "follow",
    "The camera goes along (f)",
    true,
    (on) => this.view && (this.view.follow = on),
  );
  private readonly forces = toggle(
    "forces",
    "Forces on the feet",
    true,
    (on) => this.view && ((this.view.forces = on), this.view.paint()),
  );
  private readonly trails = toggle(
    "trails",
    "Paths of the feet",
    true,
    (on) => this.view && ((this.view.trails = on), this.view.paint()),
  );
  private readonly sideBySide = toggle("side by side", "Beside each other instead of in one place (b)", false, () =>
    this.arrange(),
  );

  constructor(document_: LiveDocument) {
    document.title = "Live \u2013 Crossgait";
    const page = document.getElementById("page")!;
    page.classList.add("replay", "live");
    page.append(this.header(document_.crossgait), this.stage());
    void this.begin(page);
  }

  private async begin(page: HTMLElement): Promise<void> {
    this.driver = new Driver((velocity) => this.link.send({ do: "drive", ...velocity }));
    if (!(await this.meet())) return;
    page.append(this.results);
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      if (event.dataTransfer) void droppedFiles(event.dataTransfer).then((files) => this.link.drop(files));
    });
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("pagehide", () => this.link.close());
    this.link.watch();
  }

  /** What is driven, and what can be said to it. */
  private async meet(): Promise<boolean> {
    try {
      this.options = await this.link.options();
    } catch {
      this.say("crossgait view does not answer: start it again, and open the address that it prints");
      return false;
    }
    this.driver.limits = this.options.limits;
    this.controls = new Controls(this.options, this.driver, (command) => this.link.send(command));
    this.results.replaceChildren(this.controls.element);
    return true;
  }

  private header(version: string): HTMLElement {
    const keys = h(
      "details",
      { class: "help" },
      h("summary", {}, "keys"),
      h("dl", {}, ...KEYS.flatMap(([k, what]) => [h("dt", {}, k), h("dd", {}, what)])),
    );
    return h(
      "header",
      {},
      h("h1", { title: `Crossgait ${version}` }, "Live"),
      this.facts,
      this.trouble,
      h(
        "span",
        { class: "right" },
        keys,
        button("\u25d0", "Light or dark (t)", () => theme.toggle()),
      ),
    );
  }
  private stage(): HTMLElement {
    const stop = button("stop", "Stop walking (space)", () => this.driver.stop());
    stop.classList.add("stop");
    const transport = h(
      "div",
      { class: "transport" },
      stop,
      this.pause,
      this.step,
      this.back,
      this.pace,
      button("stand up", "stand up: back to the start (u)", () => this.link.send({ do: "stand" })),
      this.record,
      this.keep,
      this.save,
      this.clock,
    );
    const views = PRESETS.map(([preset, label, k]) =>
      button(label, `View: ${preset} (${k})`, () => this.view?.viewpoint.look(preset)),
    );
    const shows = [this.forces, this.trails, ...insideToggles(this.insides, () => this.view?.paint())];
    const hint = h("span", { class: "muted" }, "pull at the robot to push it", this.spring);
    return h(
      "div",
      { class: "stage" },
      this.holder,
      transport,
      h(
        "div",
        { class: "tools" },
        h("span", {}, ...views, this.follow),
        h("span", {}, ...shows, this.sideBySide),
        hint,
      ),
    );
  }

  private say(words: string): void {
    this.trouble.textContent = words;
  }

  private show(frame: LiveFrame): void {
    this.frame = frame;
    if (frame.subject !== this.options.subject || frame.scene !== this.scene?.revision) return void this.fetch(frame);
    const wanted = [frame.scene, ...frame.robots.map((robot) => robot.engine)].join();
    if (wanted !== this.shown) {
      this.rebuild(frame);
      this.shown = wanted;
    }
    frame.robots.forEach((robot, i) => this.runs[i]!.add(robot));
    for (const robot of this.view!.robots) robot.refreshTrails();
    this.view!.show(frame.robots[0]!.time, true);
    this.driver.heard(frame.command);
    this.controls.show(frame);
    this.tell(frame);
  }
  private tell(frame: LiveFrame): void {
    if (frame.pull) this.say(`a spring pulls with ${frame.pull_force.toFixed(1)} N`);
    else if (this.pulled) this.say("");
    this.pulled = frame.pull !== null;
    this.facts.textContent = `${this.scene!.scene.robot} on ${frame.terrain} \u00b7 ${[this.options.policy, gaitOf(frame)].filter(Boolean).join(" on ")} \u00b7 ${frame.robots.map((robot) => robot.engine).join(", ")}`;
    this.clock.textContent = `${frame.robots[0]!.time.toFixed(1)} s, ${frame.paused ? "paused" : `${frame.rate.toFixed(2)}\u00d7`}`;
    this.clock.title = "Simulated time, and how fast it passes";
    this.pause.setAttribute("aria-pressed", String(frame.paused));
    this.step.disabled = !frame.paused;
    this.back.disabled = frame.back === 0;
    if (document.activeElement !== this.pace) this.pace.value = String(frame.pace);
    this.record.setAttribute("aria-pressed", String(frame.recorded !== null));
    this.record.textContent = frame.recorded === null ? "\u25cf record" : `\u25a0 ${frame.recorded.toFixed(1)} s`;
    this.save.hidden = frame.reports === 0;
  }
  private async fetch(frame: LiveFrame): Promise<void> {
    if (this.fetching) return;
    this.fetching = true;
    try {
      if (frame.subject !== this.options.subject) await this.meet();
      this.scene = await this.link.scene();
    } catch {
      this.say("robot and ground could not be fetched");
    }
    this.fetching = false;
  }

  /** Another ground or other engines: robots and ground anew, seen from where they were. Another robot has its own size. */
  private rebuild(frame: LiveFrame): void {
    const isOther = this.shownSubject !== frame.subject;
    this.shownSubject = frame.subject;
    const before = isOther
      ? undefined
      : this.view?.viewpoint.camera.position.clone().sub(this.view.viewpoint.controls.target);
    this.view?.dispose();
    const { scene, numbers } = this.scene!;
    this.runs = frame.robots.map((robot, i) => new LiveRun(i, robot));
    const motion: Motion & Live = {
      name: "",
      side_by_side: false,
      scene,
      runs: this.runs.map((run) => run.document),
      pairs: [],
      panels: [],
      constants: [],
      shortest_contact: 0,
      notes: [],
      usual_load: (this.options.mass * GRAVITY) / 2,
      endless: scene.ground === null,
      live: true,
    };
    const canvas = h("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": `${scene.robot} in 3D. Keys w, a, s, d turn the view, plus and minus zoom.`,
    });
    this.holder.replaceChildren(canvas);
    const view = (this.view = new View(motion, this.runs, new Numbers(numbers), canvas, this.insides));
    view.follow = isOn(this.follow);
    view.forces = isOn(this.forces);
    view.trails = isOn(this.trails);
    this.sideBySide.hidden = frame.robots.length < 2;
    view.show(0, true);
    this.arrange();
    if (before) {
      view.viewpoint.camera.position.copy(view.viewpoint.controls.target).add(before);
      view.viewpoint.controls.update();
    }
    new Pusher(view, scene.standing_height || 0.2, this.options.limits.push, {
      isSpring: () => isOn(this.spring),
      push: (impulse) => this.link.send({ do: "push", impulse }),
      pull: (to) => this.link.send(to ? { do: "pull", to } : { do: "release" }),
      say: (words) => this.say(words),
    });
  }
  private arrange(): void {
    if (!this.view) return;
    this.view.sideBySide = !this.sideBySide.hidden && isOn(this.sideBySide);
    this.view.paint();
    this.view.viewpoint.look("quarter");
  }

  /** In the directions of the robot, seen from above. */
  private push(forward: number, left: number): void {
    const pose = this.frame?.robots[0]?.poses;
    if (!pose) return;
    const [x, y, z, w] = pose.slice(3, 7) as [number, number, number, number];
    const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
    const size = KEY_PUSH * this.options.limits.push;
    this.link.send({
      do: "push",
      impulse: [
        size * (forward * Math.cos(yaw) - left * Math.sin(yaw)),
        size * (forward * Math.sin(yaw) + left * Math.cos(yaw)),
        0,
      ],
    });
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || target instanceof HTMLSelectElement) return;
    if (target instanceof HTMLInputElement && target.type !== "checkbox") {
      if (target.type !== "range" || event.key.startsWith("Arrow")) return;
    }
    // A button that has the focus is pressed by space, as everywhere; all others stop the robot.
    if (event.key === " " && target.closest("button:not(.stop), input[type=checkbox], summary, a")) return;
    const view = this.view;
    const actions: Record<string, () => void> = {
      ArrowUp: () => this.driver.change(1, 0, 0),
      ArrowDown: () => this.driver.change(-1, 0, 0),
      ArrowLeft: () => this.driver.change(0, 0, 1),
      ArrowRight: () => this.driver.change(0, 0, -1),
      q: () => this.driver.change(0, 1, 0),
      e: () => this.driver.change(0, -1, 0),
      " ": () => this.driver.stop(),
      i: () => this.push(1, 0),
      k: () => this.push(-1, 0),
      j: () => this.push(0, 1),
      l: () => this.push(0, -1),
      p: () => this.pause.click(),
      ".": () => this.step.click(),
      ",": () => this.back.click(),
      u: () => this.link.send({ do: "stand" }),
      r: () => this.record.click(),
      t: () => theme.toggle(),
      f: () => this.follow.querySelector("input")!.click(),
      b: () => this.sideBySide.hidden || this.sideBySide.querySelector("input")!.click(),
      a: () => view?.viewpoint.turn(-0.15, 0, 1),
      d: () => view?.viewpoint.turn(0.15, 0, 1),
      w: () => view?.viewpoint.turn(0, 0.1, 1),
      s: () => view?.viewpoint.turn(0, -0.1, 1),
      "+": () => view?.viewpoint.turn(0, 0, 1.2),
      "-": () => view?.viewpoint.turn(0, 0, 1 / 1.2),
      ...Object.fromEntries(PRESETS.map(([preset, , k]) => [k, () => view?.viewpoint.look(preset)])),
    };
    if (!(event.key in actions)) return;
    actions[event.key]!();
    event.preventDefault();
  }
}
