// A quantity of the live robots over the last seconds, a line for each.
import uPlot from "uplot";
import { AXIS, FLOORS, rangeOf } from "./axes";
import { h } from "./dom";
import type { LiveFrame, LiveOptions, LiveRobot } from "./live_link";
import { theme } from "./theme";

const SECONDS = 10;
/** From one painting to the next, ms: more often than eyes read, and less than frames come. */
const PAUSE = 100;
const HEIGHT = 180;
const LEGS = ["FL", "FR", "RL", "RR"];

/** What may be shown: of the whole robot, of a leg or of a joint. */
interface Signal {
  name: string;
  unit: string;
  of: "robot" | "leg" | "joint";
  value: (robot: LiveRobot, index: number) => number;
}
const SIGNALS: Signal[] = [
  { name: "gap from the first", unit: "mm", of: "robot", value: (r) => 1000 * r.gap },
  { name: "height", unit: "mm", of: "robot", value: (r) => 1000 * r.height },
  { name: "forward speed", unit: "m/s", of: "robot", value: (r) => r.velocity[0] },
  { name: "load of a foot", unit: "N", of: "leg", value: (r, i) => Math.hypot(...r.forces.slice(3 * i, 3 * i + 3)) },
  { name: "torque", unit: "N m", of: "joint", value: (r, i) => r.torques[i]! },
  { name: "angle", unit: "rad", of: "joint", value: (r, i) => r.angles[i]! },
  { name: "speed", unit: "rad/s", of: "joint", value: (r, i) => r.speeds[i]! },
];

export class LivePlot {
  readonly element: HTMLElement;
  private frames: LiveRobot[][] = [];
  private plot: uPlot | null = null;
  private painted = -Infinity;
  private readonly holder = h("div", { class: "live-plot" });
  private readonly signal: HTMLSelectElement = h(
    "select",
    { "aria-label": "What is plotted", change: () => this.choose() },
    ...SIGNALS.map((s) => h("option", { value: s.name }, `${s.name}, ${s.unit}`)),
  );
  private readonly part: HTMLSelectElement = h("select", {
    "aria-label": "Of which leg or joint",
    change: () => this.rebuild(),
  });

  constructor(private readonly known: LiveOptions) {
    this.signal.value = "height";
    this.element = h("div", {}, h("div", { class: "row" }, this.signal, this.part), this.holder);
    this.choose();
    theme.onChange(() => this.rebuild());
    new ResizeObserver(() => this.plot?.setSize({ width: this.holder.clientWidth, height: HEIGHT })).observe(
      this.holder,
    );
  }

  add(frame: LiveFrame): void {
    const before = this.frames.at(-1);
    const now = frame.robots[0]!.time;
    // Other robots have another past; where time went back it is gone.
    if (before && before.map((r) => r.engine).join() !== frame.robots.map((r) => r.engine).join()) this.frames = [];
    while (this.frames.length && this.frames.at(-1)![0]!.time >= now) this.frames.pop();
    this.frames.push(frame.robots);
    while (this.frames[0]![0]!.time < now - SECONDS) this.frames.shift();
    if (performance.now() - this.painted < PAUSE) return;
    this.painted = performance.now();
    if (this.plot === null || this.plot.series.length !== frame.robots.length + 1) this.rebuild();
    else this.plot.setData(this.data());
  }

  private get chosen(): Signal {
    return SIGNALS.find((s) => s.name === this.signal.value)!;
  }
  private choose(): void {
    const names = { robot: [], leg: LEGS, joint: this.known.joints }[this.chosen.of];
    this.part.replaceChildren(...names.map((name, i) => h("option", { value: i }, name)));
    this.part.hidden = names.length === 0;
    this.rebuild();
  }
  private data(): uPlot.AlignedData {
    const { value } = this.chosen;
    const index = Number(this.part.value) || 0;
    const robots = this.frames.at(-1)?.length ?? 0;
    return [
      this.frames.map((f) => f[0]!.time),
      ...Array.from({ length: robots }, (_, k) => this.frames.map((f) => value(f[k]!, index))),
    ] as uPlot.AlignedData;
  }
  private rebuild(): void {
    this.plot?.destroy();
    this.plot = null;
    const robots = this.frames.at(-1);
    if (!robots || this.holder.clientWidth === 0) return;
    const { name, unit } = this.chosen;
    this.holder.setAttribute("role", "img");
    this.holder.setAttribute("aria-label", `${name} over the last ${SECONDS} seconds`);
    this.plot = new uPlot(
      {
        width: this.holder.clientWidth,
        height: HEIGHT,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false }, y: { range: (_, low, high) => rangeOf(low, high, FLOORS[unit] ?? 0) } },
        axes: [AXIS, { ...AXIS, size: 60 }],
        series: [
          {},
          ...robots.map((robot, i) => ({
            label: robot.engine,
            stroke: theme.runColour(i),
            dash: theme.run(i).dash,
            width: 1.5,
          })),
        ],
      },
      this.data(),
      this.holder,
    );
  }
}
