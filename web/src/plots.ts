// Plots over time whose cursor is the replay's: touching one moves the robot.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Motion, Numbers, Panel, Run } from "./document";
import { digits, h } from "./dom";
import type { Player } from "./player";
import { theme } from "./theme";

const HEIGHT = 150; // px
const NOTHING = {
  mousedown: () => null,
  mouseup: () => null,
  click: () => null,
  dblclick: () => null,
  mousemove: () => null,
  mouseleave: () => null,
  mouseenter: () => null,
};

type Column = (number | null)[];

/** A line in a plot's legend: its name and its value now. */
interface Key {
  element: HTMLElement;
  value: HTMLElement;
  colour: () => string;
}

function key(label: string, dashed: boolean, colour: () => string, title = label, hidden = false): Key {
  const value = h("output", { "aria-label": title }, "");
  const mark = h("i", { class: dashed ? "mark dashed" : "mark" });
  const element = h("span", { class: "key", title, hidden }, mark, label ? `${label} ` : "", value);
  return { element, value, colour };
}

/** How every axis looks. */
export const AXIS: uPlot.Axis = {
  stroke: () => theme.variable("--muted"),
  grid: { stroke: () => theme.variable("--rule"), width: 1 },
  ticks: { stroke: () => theme.variable("--rule"), width: 1, size: 4 },
  font: "11px system-ui, sans-serif",
};

/** A number at an axis, which has little room. */
export function short(value: number): string {
  const size = Math.abs(value);
  return (size >= 1e4 || (size > 0 && size < 1e-3) ? value.toExponential() : String(+value.toPrecision(6))).replace(
    "-",
    "\u2212",
  );
}

/** A logarithmic axis marks powers of ten. */
export const POWERS: uPlot.Axis = {
  splits: (_u, _axis, low, high) => powers(low, high),
  filter: (_, at) => at, // they are few already
  values: (_, at) => at.map((v) => v.toExponential(0).replace("-", "\u2212")),
};

function axes(unit: string): uPlot.Axis[] {
  const common = AXIS;
  const time = { ...common, size: 24, gap: 2, values: (_: uPlot, at: number[]) => at.map((t) => `${+t.toFixed(4)} s`) };
  return [time, { ...common, size: unit === "legs" ? 34 : 52, gap: 3, values: (_, at) => at.map(short) }];
}

/** One plot: made when it is first seen. */
abstract class TimePlot {
  readonly element: HTMLElement;
  protected readonly holder = h("div", { class: "plot" });
  protected plot: uPlot | null = null;
  visible = false;

  constructor(
    protected readonly player: Player,
    title: string,
    unit: string,
    protected readonly keys: Key[],
    protected readonly marks: number[],
    protected readonly height = HEIGHT,
  ) {
    const heading = h(
      "figcaption",
      {},
      h("b", {}, unit ? `${title}, ${unit}` : title),
      h("span", { class: "keys" }, ...keys.map((k) => k.element)),
    );
    this.element = h("figure", { class: "panel" }, heading, this.holder);
    this.holder.style.height = `${height}px`;
  }

  protected abstract make(width: number): uPlot;

  ensure(): void {
    if (this.plot || this.holder.clientWidth === 0) return;
    this.plot = this.make(this.holder.clientWidth);
    const over = this.plot.over;
    const seek = (event: PointerEvent) => {
      const time = this.plot!.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
      this.player.playing = false;
      this.player.seek(time);
    };
    over.addEventListener("pointerdown", (event) => {
      over.setPointerCapture(event.pointerId);
      seek(event);
    });
    over.addEventListener("pointermove", (event) => {
      if (over.hasPointerCapture(event.pointerId)) seek(event);
    });
    this.recolour();
    queueMicrotask(() => this.show()); // behind the plot's own, in which it finds its scales
  }
  resize(): void {
    const width = this.holder.clientWidth;
    if (this.plot && width > 0 && width !== this.plot.width) {
      this.plot.setSize({ width, height: this.height });
      this.show();
    }
  }
  recolour(): void {
    for (const k of this.keys) k.element.style.setProperty("--colour", k.colour());
    this.plot?.redraw(false);
  }
  /** The cursor, and the values at it. */
  show(): void {
    if (!this.plot) return;
    this.plot.setCursor({ left: this.plot.valToPos(this.player.time, "x"), top: 0 }, false);
    this.showValues();
  }
  protected showValues(): void {}
  /** Where the cursor is, s. */
  get cursorTime(): number {
    return this.plot ? this.plot.posToVal(this.plot.cursor.left ?? -1, "x") : NaN;
  }

  protected options(width: number, unit: string, rest: Partial<uPlot.Options>): uPlot.Options {
    return {
      width,
      height: this.height,
      padding: [6, 18, 0, 0],
      legend: { show: false },
      cursor: { y: false, points: { show: false }, drag: { x: false, y: false }, bind: NOTHING },
      axes: axes(unit),
      series: [],
      ...rest,
      hooks: { ...rest.hooks, draw: [...(rest.hooks?.draw ?? []), (u) => this.drawMarks(u)] },
    };
  }
  // Moments in which engines parted.
  private drawMarks(u: uPlot): void {
    u.ctx.save();
    u.ctx.strokeStyle = theme.variable("--alarm");
    u.ctx.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
    u.ctx.lineWidth = devicePixelRatio;
    for (const time of this.marks) {
      const x = Math.round(u.valToPos(time, "x", true));
      u.ctx.beginPath();
      u.ctx.moveTo(x, u.bbox.top);
      u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
      u.ctx.stroke();
    }
    u.ctx.restore();
  }
}

/** Times of all runs in one ascending column, and each series on it. */
function join(runs: Run[], panel: Panel, numbers: Numbers): Column[] {
  const used = [...new Set(panel.series.map((s) => s.run))];
  const tables = used.map((index): uPlot.AlignedData => {
    const time = Array.from(runs[index]!.time);
    const columns = panel.series
      .filter((s) => s.run === index)
      .map((s) => {
        const values: Column = Array.from(numbers.floats(s.values), (v) =>
          Number.isFinite(v) && !(panel.log && v <= 0) ? v : null,
        );
        while (values.length < time.length) values.push(null);
        return values;
      });
    return [time, ...columns] as uPlot.AlignedData;
  });
  const same = tables.every(
    (table) => table[0].length === tables[0]![0].length && table[0].every((t, i) => t === tables[0]![0][i]),
  );
  const joined = (
    same ? [tables[0]![0], ...tables.flatMap((table) => table.slice(1))] : uPlot.join(tables)
  ) as Column[];
  // In the order of the tables; back into that of the panel.
  const order = used.flatMap((index) => panel.series.flatMap((s, i) => (s.run === index ? [i] : [])));
  const result: Column[] = [joined[0]!];
  order.forEach((place, i) => (result[place + 1] = joined[i + 1]!));
  return result;
}

class SeriesPlot extends TimePlot {
  private readonly data: Column[];

  constructor(
    player: Player,
    readonly panel: Panel,
    private readonly runs: Run[],
    numbers: Numbers,
    marks: number[],
  ) {
    const several = runs.length > 1;
    const keys = panel.series.map((s, i) => {
      const name = runs[s.run]!.name;
      // Engines are known by their colours, which the gait diagram and the list below the robot name.
      const label = several && s.other === undefined && !s.dashed ? "" : s.label;
      const colour = s.other === undefined ? () => theme.colour(s.run) : () => theme.colour(i);
      // Of targets one entry will do: they are beside the angles of the same colour.
      const again = s.dashed && panel.series.findIndex((other) => other.dashed) < i;
      return key(label, s.dashed, colour, `${s.label} ${s.other === undefined ? name : ""}`.trim(), again);
    });
    super(
      player,
      panel.leg ? `${panel.leg}: ${panel.title.toLowerCase()}` : panel.title,
      panel.unit === "-" ? "" : panel.unit,
      keys,
      marks,
    );
    this.data = join(runs, panel, numbers);
  }

  protected make(width: number): uPlot {
    const count = this.runs.length;
    const several = count > 1;
    const series: uPlot.Series[] = this.panel.series.map((s, i) => ({
      stroke: () => this.keys[i]!.colour(),
      // Engines that agree lie on each other: those behind are wider.
      width: s.dashed ? 1 : several ? 1.1 + 0.8 * Math.max(0, count - 1 - i) : 1.4,
      ...(s.dashed ? { dash: [5, 4] } : {}),
      points: { show: false },
      spanGaps: !this.panel.log,
    }));
    const options = this.options(width, this.panel.unit, {
      scales: { x: { time: false }, y: this.panel.log ? { distr: 3 } : {} },
      series: [{}, ...series],
    });
    if (this.panel.log) Object.assign(options.axes![1]!, POWERS);
    return new uPlot(options, this.data as uPlot.AlignedData, this.holder);
  }
  protected showValues(): void {
    const times = this.data[0]!;
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if ((times[middle] as number) <= this.player.time + 5e-7) low = middle;
      else high = middle - 1;
    }
    this.keys.forEach((k, i) => {
      const value = this.data[i + 1]![low];
      k.value.textContent = value === null || value === undefined ? "\u2013" : digits(value);
    });
  }
}

/** Powers of ten between two numbers, at most eight, evenly apart; where there are none or one, with their doubles and halves. */
function powers(low: number, high: number): number[] {
  if (Math.log10(high / low) < 2) {
    const at: number[] = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); ++e) at.push(...[1, 2, 5].map((m) => m * 10 ** e));
    return at.filter((v) => v >= low && v <= high);
  }
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  const apart = Math.max(1, Math.ceil((last - first) / 7));
  const found: number[] = [];
  for (let exponent = first; exponent <= last; exponent += apart) found.push(10 ** exponent);
  return found;
}

/** Which feet were on the ground, and which were meant to be. */
class GaitPlot extends TimePlot {
  constructor(
    player: Player,
    private readonly motion: Motion,
    private readonly runs: Run[],
    marks: number[],
  ) {
    const several = runs.length > 1;
    const keys = runs.map((run) => key(several ? run.name : "on the ground", false, () => theme.colour(run.index)));
    if (runs[0]!.document.planned) keys.push(key("planned stance", false, () => theme.variable("--planned")));
    const shortest = motion.shortest_contact;
    const leftOut = shortest > 0 ? ` (touches and gaps under ${+(1e3 * shortest).toFixed(1)} ms left out)` : "";
    super(
      player,
      `Gait: feet on the ground${leftOut}`,
      "",
      keys,
      marks,
      44 + motion.scene.legs.length * Math.max(26, 12 + 9 * runs.length),
    );
  }

  protected make(width: number): uPlot {
    const { legs } = this.motion.scene;
    const options = this.options(width, "legs", {
      scales: { x: { time: false }, y: { range: [0, legs.length] } },
      series: [{}, { stroke: "transparent", points: { show: false } }],
      hooks: { draw: [(u) => this.drawBars(u)] },
    });
    options.axes![1]!.splits = () => legs.map((_, i) => legs.length - i - 0.5);
    options.axes![1]!.values = () => legs.map((leg) => leg.name);
    options.axes![1]!.grid = { show: false };
    const time = Array.from(this.player.frames);
    return new uPlot(options, [time, time.map(() => 0)], this.holder);
  }

  private drawBars(u: uPlot): void {
    const { legs } = this.motion.scene;
    const bar = (times: number[] | undefined, top: number, bottom: number, colour: string) => {
      u.ctx.fillStyle = colour;
      const [y0, y1] = [u.valToPos(top, "y", true), u.valToPos(bottom, "y", true)];
      for (let i = 0; i + 1 < (times?.length ?? 0); i += 2) {
        const [x0, x1] = [u.valToPos(times![i]!, "x", true), u.valToPos(times![i + 1]!, "x", true)];
        u.ctx.fillRect(x0, y0, Math.max(1, x1 - x0), y1 - y0);
      }
    };
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    legs.forEach((_, leg) => {
      const top = legs.length - leg;
      bar(this.runs[0]!.document.planned?.[leg], top - 0.06, top - 0.94, theme.variable("--planned"));
      const share = 0.68 / this.runs.length;
      this.runs.forEach((run, i) => {
        const y = top - 0.16 - i * share;
        bar(run.document.contact?.[leg], y - 0.06 * share, y - 0.94 * share, theme.colour(run.index));
      });
    });
    u.ctx.restore();
  }
}

const GROUPS: [Panel["group"], string][] = [
  ["base", "Base"],
  ["feet", "Feet"],
  ["joints", "Joints and torques"],
  ["parameters", "Gait parameters that change"],
  ["rewards", "What a policy step earns"],
  ["differences", "Differences between runs"],
];

export class Plots {
  readonly element = h("div", { class: "plots" });
  readonly all: TimePlot[] = [];
  private readonly legs: { name: string; elements: HTMLElement[] }[] = [];

  constructor(motion: Motion, runs: Run[], numbers: Numbers, player: Player) {
    const marks = motion.pairs.flatMap((pair) => (pair.first_divergence ? [pair.first_divergence.time_s] : []));
    const gait = this.add(new GaitPlot(player, motion, runs, marks));
    this.element.append(h("section", { class: "group wide" }, gait));
    for (const { name } of motion.scene.legs) this.legs.push({ name, elements: [] });
    for (const [group, title] of GROUPS) {
      const panels = motion.panels.filter((panel) => panel.group === group);
      if (panels.length === 0) continue;
      const grid = h("div", { class: "grid" });
      for (const panel of panels) {
        const element = this.add(new SeriesPlot(player, panel, runs, numbers, group === "differences" ? marks : []));
        this.legs.find((leg) => leg.name === panel.leg)?.elements.push(element);
        grid.append(element);
      }
      const chooser = group === "feet" || group === "joints" ? this.chooser(group) : null;
      this.element.append(h("section", { class: "group" }, h("h2", {}, title, chooser), grid));
    }
    this.choose(motion.scene.legs[0]?.name ?? "");
    player.onChange(() => this.show());
    theme.onChange(() => this.all.forEach((plot) => plot.recolour()));
    new ResizeObserver(() => this.all.forEach((plot) => plot.resize())).observe(this.element);
    addEventListener("beforeprint", () => this.all.forEach((plot) => plot.ensure()));
  }

  show(): void {
    for (const plot of this.all) if (plot.visible) plot.show();
  }
  choose(leg: string): void {
    for (const { name, elements } of this.legs) for (const element of elements) element.hidden = name !== leg;
    for (const button of this.element.querySelectorAll<HTMLButtonElement>("button[data-leg]"))
      button.setAttribute("aria-pressed", String(button.dataset.leg === leg));
  }

  private add(plot: TimePlot): HTMLElement {
    this.all.push(plot);
    new IntersectionObserver(
      ([entry]) => {
        plot.visible = entry!.isIntersecting;
        if (plot.visible) {
          plot.ensure();
          plot.resize();
          plot.show();
        }
      },
      { rootMargin: "200px" },
    ).observe(plot.element);
    return plot.element;
  }
  private chooser(group: string): HTMLElement {
    return h(
      "span",
      { class: "chooser", role: "group", "aria-label": `Leg whose ${group} are shown` },
      ...this.legs.map(({ name }) => h("button", { "data-leg": name, click: () => this.choose(name) }, name)),
    );
  }
}
