// Plots over time whose cursor is the replay's: touching one moves the robot.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Motion, Numbers, Panel, Run } from "./document";
import { digits, h } from "./dom";
import { saveButtons, savePng, saveSvg, svgOf, type Legend, type SvgContext } from "./figure_file";
import type { Player } from "./player";
import { theme } from "./theme";

const HEIGHT = 150; // px
const TARGET = [5, 4]; // px: dashes of what is meant, beside what is
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
  title: string;
  dash: number[] | undefined;
}

function key(
  label: string,
  dash: number[] | undefined,
  colour: () => string,
  title = label,
  hidden: boolean = false,
): Key {
  const value = h("output", { "aria-label": title }, "");
  const mark = h("i", { class: dash ? "mark dashed" : "mark" });
  const element = h("span", { class: "key", title, hidden }, mark, label ? `${label} ` : "", value);
  return { element, value, colour, title, dash };
}

/** Smallest ranges of what is plotted, by unit: below them is what nobody would act on. */
const FLOORS: Record<string, number> = {
  deg: 0.1,
  "deg/s": 1,
  rad: 1e-3,
  m: 1e-3,
  mm: 0.1,
  "m/s": 1e-3,
  N: 0.1,
  "N m": 1e-3,
};

/** What an axis shows of values from `low` to `high`. */
export function rangeOf(low: number | null, high: number | null, floor: number): [number, number] {
  if (low === null || high === null) return [0, floor || 1];
  if (high - low >= floor && high > low) return uPlot.rangeNum(low, high, 0.1, true) as [number, number];
  const half = 0.5 * Math.max(floor, high - low) || 0.5;
  const middle = 0.5 * (low + high);
  return Math.abs(middle) < half ? [-half, half] : [middle - half, middle + half];
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
  return (size >= 1e4 || (size > 0 && size < 1e-3) ? value.toExponential() : String(+value.toPrecision(6))).replaceAll(
    "-",
    "\u2212",
  );
}

/** A logarithmic axis marks powers of ten. */
export const POWERS: uPlot.Axis = {
  splits: (_u, _axis, low, high) => powers(low, high),
  filter: (_, at) => at, // they are few already
  values: (_, at) => at.map((v) => v.toExponential(0).replaceAll("-", "\u2212")),
};

/** @param begin  of the motion, since which time is told */
function axes(unit: string, begin: number): uPlot.Axis[] {
  const common = AXIS;
  const time: uPlot.Axis = {
    ...common,
    size: 24,
    gap: 2,
    splits: (_u, _axis, low, high, apart) => {
      const at: number[] = [];
      for (let k = Math.ceil((low - begin) / apart - 1e-6); begin + k * apart <= high; ++k) at.push(begin + k * apart);
      return at;
    },
    values: (_, at) => at.map((t) => `${+(t - begin).toFixed(4)} s`),
  };
  return [time, { ...common, size: unit === "legs" ? 34 : 52, gap: 3, values: (_, at) => at.map(short) }];
}

/** One plot: made when it is first seen. */
abstract class TimePlot {
  readonly element: HTMLElement;
  protected readonly holder = h("div", { class: "plot" });
  protected plot: uPlot | null = null;
  private readonly title: string;
  visible = false;

  constructor(
    protected readonly player: Player,
    title: string,
    unit: string,
    protected readonly keys: Key[],
    protected readonly marks: number[],
    protected readonly height = HEIGHT,
  ) {
    this.title = unit ? `${title}, ${unit}` : title;
    const heading = h(
      "figcaption",
      {},
      h("b", {}, this.title),
      h(
        "span",
        { class: "keys" },
        ...keys.map((k) => k.element),
        saveButtons((how) => this.save(how)),
      ),
    );
    this.element = h("figure", { class: "panel" }, heading, this.holder);
    this.holder.style.height = `${height}px`;
  }

  protected abstract make(width: number): uPlot;
  /** What lies within the axes. */
  protected abstract drawSvg(u: uPlot, context: SvgContext): void;

  /** As a file; null before it is drawn. */
  svg(): string | null {
    return this.plot && svgOf(this.plot, this.title, this.legend(), (context) => this.drawSvg(this.plot!, context));
  }
  private save(how: "png" | "svg"): void {
    this.ensure();
    if (!this.plot) return;
    if (how === "png") savePng(this.plot, this.title, this.legend());
    else saveSvg(this.plot, this.title, this.legend(), (context) => this.drawSvg(this.plot!, context));
  }
  private legend(): Legend[] {
    return this.keys
      .filter((k) => !k.element.hidden && k.title)
      .map((k) => ({ label: k.title, colour: k.colour(), dash: k.dash }));
  }

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
      axes: axes(unit, this.player.begin),
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
      // Of a difference the other engine is the one that is looked at.
      const whose = s.other ?? s.run;
      // Engines are known by their colours, which the gait diagram and the list below the robot name.
      const label = several && s.other === undefined && !s.dashed ? "" : s.label;
      // Of targets one entry will do: they are beside the angles of the same colour.
      const again = s.dashed && panel.series.findIndex((other) => other.dashed) < i;
      const dash = s.dashed ? TARGET : theme.run(whose).dash;
      const title = `${s.label} ${s.other === undefined ? name : ""}`.trim();
      return key(label, dash, () => theme.runColour(whose), title, again);
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
      ...(this.keys[i]!.dash ? { dash: this.keys[i]!.dash! } : {}),
      points: { show: false },
      spanGaps: !this.panel.log,
    }));
    const options = this.options(width, this.panel.unit, {
      scales: {
        x: { time: false },
        y: this.panel.log ? { distr: 3 } : { range: (_, low, high) => rangeOf(low, high, this.floor) },
      },
      series: [{}, ...series],
    });
    if (this.panel.log) Object.assign(options.axes![1]!, POWERS);
    return new uPlot(options, this.data as uPlot.AlignedData, this.holder);
  }
  /** Smallest range of the axis; values of less than a hundredth of it are told as zero. */
  private get floor(): number {
    return this.panel.log ? 0 : (FLOORS[this.panel.unit] ?? 0);
  }
  protected drawSvg(u: uPlot, context: SvgContext): void {
    this.panel.series.forEach((s, i) => {
      context.strokeStyle = this.keys[i]!.colour();
      context.lineWidth = s.dashed ? 1 : 1.5;
      context.dash = this.keys[i]!.dash ?? [];
      let piece: [number, number][] = [];
      this.data[i + 1]!.forEach((value, k) => {
        if (typeof value === "number") {
          piece.push([u.valToPos(this.data[0]![k]!, "x"), u.valToPos(value, "y")]);
          return;
        }
        // A gap of a logarithmic plot, where the value is none.
        if (this.panel.log && piece.length > 1) context.line(piece);
        if (this.panel.log) piece = [];
      });
      if (piece.length > 1) context.line(piece);
    });
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
      const none = value === null || value === undefined;
      k.value.textContent = none ? "\u2013" : digits(Math.abs(value) < 0.01 * this.floor ? 0 : value);
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
    const keys = runs.map((run) =>
      key(several ? run.name : "on the ground", theme.run(run.index).dash, () => theme.runColour(run.index)),
    );
    if (runs[0]!.document.planned) keys.push(key("planned stance", undefined, () => theme.variable("--planned")));
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
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    this.bars(u, true, (x, y, width, height, colour) => {
      u.ctx.fillStyle = colour;
      u.ctx.fillRect(x, y, width, height);
    });
    u.ctx.restore();
  }
  protected drawSvg(u: uPlot, context: SvgContext): void {
    this.bars(u, false, (x, y, width, height, colour) => {
      context.fillStyle = colour;
      context.rectangle(x, y, width, height);
    });
  }
  /** @param inCanvas  in its pixels, else in those of the page within the axes */
  private bars(
    u: uPlot,
    inCanvas: boolean,
    draw: (x: number, y: number, width: number, height: number, colour: string) => void,
  ): void {
    const { legs } = this.motion.scene;
    const bar = (times: number[] | undefined, top: number, bottom: number, colour: string) => {
      const [y0, y1] = [u.valToPos(top, "y", inCanvas), u.valToPos(bottom, "y", inCanvas)];
      for (let i = 0; i + 1 < (times?.length ?? 0); i += 2) {
        const [x0, x1] = [u.valToPos(times![i]!, "x", inCanvas), u.valToPos(times![i + 1]!, "x", inCanvas)];
        draw(x0, y0, Math.max(1, x1 - x0), y1 - y0, colour);
      }
    };
    legs.forEach((_, leg) => {
      const top = legs.length - leg;
      bar(this.runs[0]!.document.planned?.[leg], top - 0.06, top - 0.94, theme.variable("--planned"));
      const share = 0.68 / this.runs.length;
      this.runs.forEach((run, i) => {
        const y = top - 0.16 - i * share;
        // What is dashed as a line is a thinner bar.
        const thin = theme.run(run.index).dash ? 0.3 : 0.06;
        bar(run.document.contact?.[leg], y - thin * share, y - (1 - thin) * share, theme.runColour(run.index));
      });
    });
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

  /** @param end  of these runs on the page */
  constructor(motion: Motion, runs: Run[], numbers: Numbers, player: Player, end: AbortSignal) {
    const isLike = (i: number) => motion.pairs.some((pair) => pair.b === i && pair.same);
    const marks = motion.pairs.flatMap(({ a, b, parting: { time_s: at } }) =>
      a === 0 && at !== null && !isLike(b) ? [at] : [],
    );
    const gait = this.add(new GaitPlot(player, motion, runs, marks));
    this.element.append(h("section", { class: "group wide" }, gait));
    for (const { name } of motion.scene.legs) this.legs.push({ name, elements: [] });
    for (const [group, title] of GROUPS) {
      // Differences are those from the first engine, of engines that are not like another.
      const panels = motion.panels
        .filter((panel) => panel.group === group)
        .map((panel) => ({
          ...panel,
          series: panel.series.filter((s) => s.other === undefined || (s.run === 0 && !isLike(s.other))),
        }))
        .filter((panel) => panel.series.length > 0);
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
    theme.onChange(() => this.all.forEach((plot) => plot.recolour()), end);
    const observer = new ResizeObserver(() => this.all.forEach((plot) => plot.resize()));
    observer.observe(this.element);
    end.addEventListener("abort", () => observer.disconnect());
    addEventListener("beforeprint", () => this.all.forEach((plot) => plot.ensure()), { signal: end });
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
