// A plot over time: its legend, its cursor, which is the replay's, and how it is saved.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { timeAxes } from "./axes";
import { h } from "./dom";
import { saveButtons, savePng, saveSvg, svgOf, type Legend, type SvgContext } from "./figure_file";
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

/** A line in a plot's legend: its name and its value now. */
export interface Key {
  element: HTMLElement;
  value: HTMLElement;
  colour: () => string;
  title: string;
  dash: number[] | undefined;
}

export function key(
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

/** One plot: made when it is first seen. */
export abstract class TimePlot {
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
      axes: timeAxes(unit, this.player.begin),
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
