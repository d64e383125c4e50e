// The page: what the document holds, laid out and wired together.
import { charts, chartsSection } from "./charts";
import { Numbers, readDocument, Run, type Motion, type ReportDocument } from "./document";
import { button, h, toggle } from "./dom";
import { footPaths } from "./feet";
import { LivePage } from "./live";
import { Player } from "./player";
import { Plots } from "./plots";
import "./style.css";
import { constants, findings, origin } from "./tables";
import { theme } from "./theme";
import { verdictSection } from "./verdict";
import { PRESETS, View } from "./view";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];
/** Robot, transport and what is shown. */
class Stage {
  readonly element: HTMLElement;
  readonly view: View;
  private readonly play = button("\u25b6", "Play or pause (space)", () => this.player.toggle());
  private readonly scrub: HTMLInputElement;
  private readonly clock = h("output", { class: "clock" });
  private readonly speed: HTMLSelectElement;
  private readonly follow: HTMLInputElement;

  constructor(
    private readonly motion: Motion,
    runs: Run[],
    numbers: Numbers,
    private readonly player: Player,
  ) {
    const canvas = h("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": `${motion.scene.robot} in 3D. Keys w, a, s, d turn the view, plus and minus zoom.`,
    });
    const holder = h("div", { class: "canvas" }, canvas);
    this.scrub = h("input", {
      type: "range",
      min: player.begin,
      max: player.end,
      step: "any",
      "aria-label": "Time, s",
      input: () => {
        this.player.playing = false;
        this.player.seek(Number(this.scrub.value));
      },
    });
    this.speed = h(
      "select",
      { "aria-label": "Speed", title: "Speed ([ and ])", change: () => (this.player.speed = Number(this.speed.value)) },
      ...SPEEDS.map((s) => h("option", { value: s, selected: s === 1 }, `${s}\u00d7`)),
    );
    this.follow = h("input", {
      type: "checkbox",
      checked: true,
      change: () => (this.view.follow = this.follow.checked),
    });
    const marks = h(
      "div",
      { class: "marks" },
      ...this.divergences((pair, at) =>
        h("i", { style: `left:${(100 * (at - player.begin)) / (player.end - player.begin || 1)}%`, title: pair }),
      ),
    );
    const transport = h(
      "div",
      { class: "transport" },
      button("\u2039", "One frame back (left arrow)", () => player.step(-1)),
      this.play,
      button("\u203a", "One frame on (right arrow)", () => player.step(1)),
      h("div", { class: "scrub" }, this.scrub, marks),
      this.clock,
      this.speed,
    );
    this.element = h("div", { class: "stage" }, holder, transport, h("div", { class: "tools" }));
    this.view = new View(motion, runs, numbers, canvas);
    this.element.lastElementChild!.append(...this.tools(runs));
    player.onChange(() => this.show());
    this.show();
  }

  private divergences<T>(make: (words: string, at: number, names: string) => T): T[] {
    return this.motion.pairs.flatMap(({ a, b, first_divergence: first }) => {
      const names = `${this.motion.runs[a]!.name} and ${this.motion.runs[b]!.name}`;
      return first
        ? [
            make(
              `${names} part: ${first.quantity} beyond ${first.tolerance}, at ${first.time_s.toFixed(3)} s`,
              first.time_s,
              names,
            ),
          ]
        : [];
    });
  }
  private tools(runs: Run[]): HTMLElement[] {
    const several = runs.length > 1;
    const engines = runs.map((run, i) => {
      const label = toggle(run.name, `Show ${run.name}`, true, (on) => {
        this.view.shown[i] = on;
        this.view.paint();
      });
      label.classList.add("engine");
      const paint = () => label.style.setProperty("--colour", theme.colour(i));
      theme.onChange(paint);
      paint();
      return label;
    });
    const layout = toggle("side by side", "Beside each other instead of in one place (b)", false, (on) => {
      this.view.sideBySide = on;
      this.view.paint();
      this.view.look("quarter");
    });
    const parted = this.divergences((words, at, names) =>
      button(`${names} part at ${at.toFixed(3)} s`, `${words}. Go there (p)`, () => {
        this.player.playing = false;
        this.player.seek(at);
      }),
    );
    layout.id = "layout";
    const forces = runs.every((run) => run.document.force_directions)
      ? "Forces on the feet"
      : "Forces on the feet; of traces the magnitude alone is known, drawn upright";
    return [
      ...(several ? [h("span", {}, ...engines, layout)] : []),
      h(
        "span",
        {},
        ...PRESETS.map(([preset, label, k]) => button(label, `View: ${preset} (${k})`, () => this.view.look(preset))),
        h("label", { title: "The camera goes along (f)" }, this.follow, "follow"),
      ),
      h(
        "span",
        {},
        toggle("forces", forces, true, (on) => ((this.view.forces = on), this.view.paint())),
        toggle("trails", "Paths of the feet", true, (on) => ((this.view.trails = on), this.view.paint())),
        toggle(
          "support",
          "What the loaded feet span, and the centre of mass above it",
          false,
          (on) => ((this.view.support = on), this.view.paint()),
        ),
      ),
      ...(parted.length > 0 ? [h("span", { class: "parted" }, ...parted)] : []),
    ];
  }
  private show(): void {
    const { time, playing, end } = this.player;
    this.play.textContent = playing ? "\u275a\u275a" : "\u25b6";
    this.scrub.value = String(time);
    this.clock.textContent = `${time.toFixed(3)} / ${end.toFixed(2)} s`;
    this.view.show(time, !playing);
  }

  /** @returns whether the key means something here */
  press(name: string, shift: boolean): boolean {
    const actions: Record<string, () => void> = {
      " ": () => this.player.toggle(),
      ArrowLeft: () => this.player.step(shift ? -10 : -1),
      ArrowRight: () => this.player.step(shift ? 10 : 1),
      Home: () => this.player.seek(this.player.begin),
      End: () => this.player.seek(this.player.end),
      "[": () => this.hurry(-1),
      "]": () => this.hurry(1),
      f: () => this.follow.click(),
      b: () => this.element.querySelector<HTMLInputElement>("#layout input")?.click(),
      p: () => this.element.querySelector<HTMLButtonElement>(".parted button")?.click(),
      a: () => this.view.turn(-0.15, 0, 1),
      d: () => this.view.turn(0.15, 0, 1),
      w: () => this.view.turn(0, 0.1, 1),
      s: () => this.view.turn(0, -0.1, 1),
      "+": () => this.view.turn(0, 0, 1.2),
      "-": () => this.view.turn(0, 0, 1 / 1.2),
      ...Object.fromEntries(PRESETS.map(([preset, , k]) => [k, () => this.view.look(preset)])),
    };
    actions[name]?.();
    return name in actions;
  }
  private hurry(by: number): void {
    const at = SPEEDS.indexOf(this.player.speed);
    this.player.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at + by))]!;
    this.speed.value = String(this.player.speed);
  }
}

const KEYS: [string, string][] = [
  ["space", "play, pause"],
  ["\u2190 \u2192", "one frame (with shift: ten)"],
  ["Home End", "begin, end"],
  ["[ ]", "slower, faster"],
  ["1 2 3 4", "three-quarter, side, front, top"],
  ["w a s d + \u2212", "turn, zoom"],
  ["f b p", "follow, side by side, first parting"],
  ["t", "light, dark"],
];

function header(report: ReportDocument): HTMLElement {
  const { motion } = report;
  const facts = motion
    ? `${motion.scene.robot} on ${motion.scene.terrain} \u00b7 ${motion.runs.map((run) => (run.engine ? `${run.name} (${run.engine})` : run.name)).join(", ")}`
    : report.verdicts.length > 1
      ? `${new Set(report.verdicts.flatMap((v) => v.engines)).size} engines`
      : report.verdicts.map((v) => `${v.engines.join(" and ")}: ${v.word}`).join(", ");
  const keys = h(
    "details",
    { class: "help" },
    h("summary", {}, "keys"),
    h("dl", {}, ...KEYS.flatMap(([k, what]) => [h("dt", {}, k), h("dd", {}, what)])),
  );
  return h(
    "header",
    {},
    h("h1", {}, report.title),
    h("p", {}, facts),
    h(
      "span",
      { class: "right" },
      motion ? keys : null,
      button("\u25d0", "Light or dark (t)", () => theme.toggle()),
    ),
  );
}

function listen(stage: Stage | null): void {
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || target instanceof HTMLSelectElement) return;
    // A button that has the focus is pressed by space, as everywhere.
    if (event.key === " " && target.closest("button, input[type=checkbox], summary")) return;
    if (event.key === "t") theme.toggle();
    else if (stage?.press(event.key, event.shiftKey)) event.preventDefault();
  });
}

function buildReport(report: ReportDocument): object {
  document.title = `${report.title} \u2013 Crossgait`;
  const page = document.getElementById("page")!;
  page.append(header(report));
  const { motion } = report;
  const results = h("div", { class: "results" });
  let stage: Stage | null = null;
  let handles: object = { report };
  const numbers = new Numbers();
  if (motion) {
    const runs = motion.runs.map((run, index) => new Run(index, run, numbers));
    const longest = runs.reduce((a, b) => (b.time[b.time.length - 1]! > a.time[a.time.length - 1]! ? b : a));
    const player = new Player(longest.time);
    page.classList.add("replay");
    stage = new Stage(motion, runs, numbers, player);
    const plots = new Plots(motion, runs, numbers, player);
    page.append(stage.element, results);
    const feet = chartsSection("Paths of the feet in the leg frames", footPaths(motion, runs), numbers)!;
    results.append(plots.element, feet.element, ...[constants(motion)].filter((e) => e !== null));
    const notes = [...motion.notes, ...motion.scene.notes];
    if (notes.length > 0)
      results.append(
        h(
          "section",
          { class: "group" },
          h("h2", {}, "Rendering notes"),
          h("ul", {}, ...notes.map((note) => h("li", {}, note))),
        ),
      );
    handles = { report, runs, player, view: stage.view, plots, feet: feet.figures };
  } else {
    page.append(results);
  }
  // Of a verdict first what it comes to, then every pair.
  const judged = !motion && report.verdicts.length > 0;
  const found = findings(
    report,
    judged ? (report.verdicts.length > 1 ? "Which engines agree" : "Verdict") : motion ? "Statistics" : "Numbers",
  );
  if (found && judged) results.append(found);
  for (const verdict of report.verdicts) results.append(verdictSection(verdict));
  const drawn = charts(report, numbers);
  results.append(...drawn.elements);
  if (found && !judged) results.append(found);
  results.append(origin(report));
  listen(stage);
  return { ...handles, charts: drawn.figures };
}

// For tests, and for those who want more of the numbers: the browser's console has them all.
const shown = readDocument();
Object.assign(window, { crossgait: "live" in shown ? new LivePage(shown) : buildReport(shown) });
