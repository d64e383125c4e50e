// Plots over time whose cursor is the replay's: touching one moves the robot.
import uPlot from "uplot";
import { FLOORS, POWERS, rangeOf } from "./axes";
import type { Motion, Numbers, Panel, Run } from "./document";
import { digits, h } from "./dom";
import type { SvgContext } from "./figure_file";
import { GaitPlot } from "./gait_plot";
import type { Player } from "./player";
import { theme } from "./theme";
import { key, TimePlot } from "./time_plot";

const TARGET = [5, 4]; // px: dashes of what is meant, beside what is

type Column = (number | null)[];

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

const GROUPS: [Panel["group"], string][] = [
  ["base", "Base"],
  ["feet", "Feet"],
  ["joints", "Joints and torques"],
  ["parameters", "Gait parameters that change"],
  ["rewards", "What a policy step earns"],
  ["differences", "Differences between runs"],
];

/** From one place of the cursor to the next while a replay plays, ms: numbers are read no sooner. */
const PACE = 100;

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
    let shown = -Infinity;
    player.onChange(() => {
      const now = performance.now();
      if (player.playing && now - shown < PACE) return;
      shown = now;
      this.show();
    });
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
