// Robot, transport and what is shown of a replay.
import { saveImage } from "./figure_file";
import { Numbers, Run, type Motion } from "./document";
import { button, h, toggle } from "./dom";
import { insideToggles } from "./insides";
import type { Player } from "./player";
import { theme } from "./theme";
import { View } from "./view";
import { PRESETS } from "./viewpoint";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];

/** A moment in which something happened to an engine. */
interface Moment {
  time: number;
  words: string;
  /** Of the engine that it happened to. */
  run: number;
}

/** Where there is no WebGL there is no view. */
function makeView(motion: Motion, runs: Run[], numbers: Numbers, canvas: HTMLCanvasElement): View | null {
  try {
    return new View(motion, runs, numbers, canvas);
  } catch (problem) {
    console.info("no picture:", problem);
    return null;
  }
}

/** Robot, transport and what is shown. */
export class Stage {
  readonly element: HTMLElement;
  /** Null without WebGL. */
  readonly view: View | null;
  private readonly play = button("\u25b6", "Play or pause (space)", () => this.player.toggle());
  private readonly scrub: HTMLInputElement;
  private readonly clock = h("output", { class: "clock", title: "s since the motion began" });
  private readonly speed: HTMLSelectElement;
  private readonly follow: HTMLInputElement;

  constructor(
    private readonly motion: Motion,
    runs: Run[],
    numbers: Numbers,
    private readonly player: Player,
    private readonly end: AbortSignal,
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
      change: () => this.view && (this.view.follow = this.follow.checked),
    });
    const moments = this.moments();
    const marks = h("div", { class: "marks" }, ...moments.map((moment) => this.mark(moment)));
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
    this.view = makeView(motion, runs, numbers, canvas);
    if (!this.view) {
      holder.replaceChildren(
        h("p", {}, "No picture of the robot: this browser has no WebGL. Plots, tables and numbers are all here."),
      );
      holder.classList.add("missing");
    }
    this.element.lastElementChild!.append(...this.tools(runs, moments));
    if (motion.side_by_side) this.view?.stand(true);
    end.addEventListener("abort", () => this.view?.dispose());
    player.onChange(() => this.show());
    this.show();
  }

  /** Of engines that are no other's like: when they came to what became of them, and when they parted from the first. */
  private moments(): Moment[] {
    const { pairs, runs } = this.motion;
    const isLike = (i: number) => pairs.some((pair) => pair.b === i && pair.same);
    const outcomes = runs.flatMap(({ name, outcome, outcome_at_s: at }, run) =>
      at === null || isLike(run) ? [] : [{ time: at, words: `${name} ${outcome}`, run }],
    );
    const partings = pairs.flatMap(({ a, b, parting: { time_s: at } }) =>
      at === null || a !== 0 || isLike(b)
        ? []
        : [{ time: at, words: `${runs[b]!.name} parts from ${runs[a]!.name}`, run: b }],
    );
    return [...partings, ...outcomes];
  }
  private mark({ time, words, run }: Moment): HTMLElement {
    const { begin, end } = this.player;
    const mark = h("i", { style: `left:${(100 * (time - begin)) / (end - begin || 1)}%`, title: words });
    const paint = () => mark.style.setProperty("--colour", theme.runColour(run));
    theme.onChange(paint, this.end);
    paint();
    return mark;
  }
  private goTo(time: number): void {
    this.player.playing = false;
    this.player.seek(time);
  }

  private tools(runs: Run[], moments: Moment[]): HTMLElement[] {
    const several = runs.length > 1;
    const jumps = moments.map(({ time, words }, i) => {
      // What became of a robot says when that was.
      const label = / at [\d.]+ s$/.test(words) ? words : `${words} at ${this.player.since(time).toFixed(2)} s`;
      return button(label, `${label}. Go there${i === 0 ? " (p)" : ""}`, () => this.goTo(time));
    });
    return [
      ...(several && this.view ? [h("span", {}, ...this.engines(runs, this.view))] : []),
      ...(this.view ? this.viewTools(this.view, runs) : []),
      ...(jumps.length > 0 ? [h("span", { class: "parted" }, ...jumps)] : []),
    ];
  }
  /** Which engines are shown, and how they stand. */
  private engines(runs: Run[], view: View): HTMLElement[] {
    const engines = runs.map((run, i) => {
      const like = view.standsFor(i);
      const words = like === i ? run.name : `${run.name} = ${runs[like]!.name}`;
      const label = toggle(words, `Show ${words}`, true, (on) => {
        view.shown[i] = on;
        view.paint();
        view.viewpoint.onLook();
      });
      label.classList.add("engine");
      label.dataset.run = run.name;
      label.classList.toggle("dashed", theme.run(i).dash !== undefined);
      const paint = () => label.style.setProperty("--colour", theme.runColour(i));
      theme.onChange(paint, this.end);
      paint();
      return label;
    });
    const layout = toggle(
      "side by side",
      "Beside each other instead of in one place (b)",
      this.motion.side_by_side,
      (on) => view.stand(on),
    );
    layout.id = "layout";
    return [...engines, layout];
  }
  private viewTools(view: View, runs: Run[]): HTMLElement[] {
    const forces = runs.every((run) => run.document.force_directions)
      ? "Forces on the feet"
      : "Forces on the feet; of traces the magnitude alone is known, drawn upright";
    return [
      h(
        "span",
        {},
        ...PRESETS.map(([preset, label, k]) =>
          button(label, `${label}: view ${preset} (${k})`, () => view.viewpoint.look(preset)),
        ),
        h("label", { title: "The camera goes along (f)" }, this.follow, "follow"),
        button("picture", "picture: save it as PNG", () => {
          view.drawNow();
          saveImage(view.canvas, `${this.motion.scene.robot} at ${this.player.since(this.player.time).toFixed(2)} s`);
        }),
      ),
      h(
        "span",
        {},
        toggle("forces", forces, true, (on) => ((view.forces = on), view.paint())),
        toggle("trails", "Paths of the feet", true, (on) => ((view.trails = on), view.paint())),
        toggle(
          "support",
          "What the loaded feet span, and the centre of mass above it",
          false,
          (on) => ((view.support = on), view.paint()),
        ),
        ...insideToggles(view.insides, () => view.paint()),
      ),
    ];
  }
  private show(): void {
    const { time, playing, end } = this.player;
    this.play.textContent = playing ? "\u275a\u275a" : "\u25b6";
    this.scrub.value = String(time);
    this.clock.textContent = `${this.player.since(time).toFixed(3)} / ${this.player.since(end).toFixed(2)} s`;
    this.view?.show(time, !playing);
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
      a: () => this.view?.viewpoint.turn(-0.15, 0, 1),
      d: () => this.view?.viewpoint.turn(0.15, 0, 1),
      w: () => this.view?.viewpoint.turn(0, 0.1, 1),
      s: () => this.view?.viewpoint.turn(0, -0.1, 1),
      "+": () => this.view?.viewpoint.turn(0, 0, 1.2),
      "-": () => this.view?.viewpoint.turn(0, 0, 1 / 1.2),
      ...Object.fromEntries(PRESETS.map(([preset, , k]) => [k, () => this.view?.viewpoint.look(preset)])),
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
