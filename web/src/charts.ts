// Curves, dots, boxes and shades over any axis: what benchmarks, searches, workspaces and gaits show.
import uPlot from "uplot";
import type { Chart, Numbers, ReportDocument } from "./document";
import { digits, h } from "./dom";
import { saveButtons, savePng, saveSvg, type Legend, type SvgContext } from "./figure_file";
import { AXIS, POWERS, short } from "./axes";
import { theme } from "./theme";

const HEIGHT = 240; // px
const NAMES_WIDTH = 110; // px
const NUMBERS_WIDTH = 56; // px
const TOP = 8; // px above the axes
const RIGHT = 18; // px
const BELOW = 52; // px: numbers and the label of x
const MANY = 40; // dots, which are small then
const EQUAL_HEIGHTS = [160, 360]; // px, of axes whose height follows from their width

// From dark to bright, so that it is read without colours, too (viridis, by Smith and van der Walt, 2015).
const SHADES = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"];

type Column = (number | null)[];
type Span = [number, number];
type Series = Chart["series"][number];

function drawable(chart: Chart, [x, y]: [number, number]): boolean {
  return (!chart.x_log || x > 0) && (!chart.y_log || y > 0);
}

/** One ascending column of x, and each series on it. */
function columns(chart: Chart, series: Series[], x: Span): Column[] {
  if (series.length === 0) return [x, [null, null]]; // for the axes
  const tables = series.map((s): uPlot.AlignedData => {
    const points = s.points.filter((p) => drawable(chart, p));
    // Two dots at one x stay two.
    return [
      points.map(([x], i) => (i > 0 && points[i - 1]![0] === x ? x * (1 + 1e-12 * i) + 1e-300 : x)),
      points.map(([, y]) => y),
    ];
  });
  return tables.length === 1 ? (tables[0] as Column[]) : (uPlot.join(tables) as Column[]);
}

/** What a chart holds along x (0) or y (1). */
function contents(chart: Chart, axis: 0 | 1): Span {
  const values = [
    ...chart.series.flatMap((s) => s.points.filter((p) => drawable(chart, p)).map((p) => p[axis])),
    ...chart.boxes.flatMap((b) => b.boxes.flatMap((box) => [box[axis], box[axis + 2]!])),
    ...(chart.shades ? [chart.shades.min[axis], chart.shades.max[axis]] : []),
  ];
  return values.reduce<Span>(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
}

/** Room around what there is, so that nothing lies on the frame. */
function roomy([low, high]: Span, log: boolean): Span {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return log ? [1e-3, 1] : [0, 1];
  if (log) return [low / 1.6, high * 1.6];
  const room = 0.06 * (high - low || Math.abs(high) || 1);
  return [low >= 0 && low < 0.5 * high ? 0 : low - room, high + room];
}

/** Wider about its middle. */
function widened([low, high]: Span, length: number): Span {
  const middle = (low + high) / 2;
  return [middle - length / 2, middle + length / 2];
}

function rgb(colour: string): number[] {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}

/** A pixel for each value, the first row at the bottom; clear where there is none. */
function picture(shades: NonNullable<Chart["shades"]>, values: Float32Array, brightest: number): HTMLCanvasElement {
  const [columns, rows] = shades.count;
  const canvas = h("canvas", { width: columns, height: rows });
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(columns, rows);
  const colours = SHADES.map(rgb);
  values.forEach((value, i) => {
    if (Number.isNaN(value)) return;
    const place = Math.min(1, Math.max(0, value / brightest)) * (colours.length - 1);
    const [dark, share] = [
      Math.min(colours.length - 2, Math.floor(place)),
      place - Math.min(colours.length - 2, Math.floor(place)),
    ];
    const at = 4 * ((rows - 1 - Math.floor(i / columns)) * columns + (i % columns));
    for (let c = 0; c < 3; ++c) image.data[at + c] = colours[dark]![c]! * (1 - share) + colours[dark + 1]![c]! * share;
    image.data[at + 3] = 255;
  });
  context.putImageData(image, 0, 0);
  return canvas;
}

export class ChartFigure {
  readonly element: HTMLElement;
  private readonly holder = h("div", { class: "plot still" });
  private readonly marks: { element: HTMLElement; colour: number }[];
  private readonly shades: HTMLCanvasElement | null;
  private plot: uPlot | null = null;
  private readonly title: string;

  /** @param brightest  of the shades of all charts that stand together */
  constructor(
    readonly chart: Chart,
    numbers: Numbers,
    brightest: number,
  ) {
    this.marks = [...chart.boxes, ...chart.series]
      .filter((s) => s.label)
      .map((s) => ({ element: h("span", { class: "key" }, h("i", { class: "mark" }), s.label), colour: s.colour }));
    this.shades = chart.shades ? picture(chart.shades, numbers.floats(chart.shades.values), brightest) : null;
    const scale = chart.shades
      ? [
          h(
            "span",
            { class: "key" },
            `${chart.shades.label} 0 `,
            h("i", { class: "shades", style: `background: linear-gradient(90deg, ${SHADES.join(", ")})` }),
            ` ${digits(brightest)}`,
          ),
        ]
      : [];
    this.title = [chart.title, chart.y_label].filter(Boolean).join(": ");
    this.element = h(
      "figure",
      { class: "panel" },
      h(
        "figcaption",
        {},
        h("b", {}, this.title),
        h(
          "span",
          { class: "keys" },
          ...this.marks.map((m) => m.element),
          ...scale,
          saveButtons((how) => this.save(how)),
        ),
      ),
      this.holder,
    );
    theme.onChange(() => this.recolour());
    new ResizeObserver(() => this.fit()).observe(this.holder);
  }

  /** The x and y of every dot that is drawn, series by series. */
  get points(): [number, number][][] {
    return this.chart.series.map((s) => s.points.filter((p) => drawable(this.chart, p)));
  }
  /** How long a unit is along x and along y, px; null before it is drawn. */
  get pixelsPerUnit(): Span | null {
    const { plot } = this;
    return (
      plot && [
        Math.abs(plot.valToPos(1, "x") - plot.valToPos(0, "x")),
        Math.abs(plot.valToPos(1, "y") - plot.valToPos(0, "y")),
      ]
    );
  }

  /** The axes of a figure of this width: what they show, and how high it is, px. */
  private axes(width: number): { x: Span; y: Span; height: number } {
    const { chart } = this;
    const x = roomy(contents(chart, 0), chart.x_log);
    const names = chart.y_names.map(([at]) => at);
    const y: Span =
      names.length > 0 ? [Math.min(...names) - 0.6, Math.max(...names) + 0.6] : roomy(contents(chart, 1), chart.y_log);
    if (!chart.equal_scales) return { x, y, height: Math.max(HEIGHT, 60 + 34 * names.length) };
    const inner = width - NUMBERS_WIDTH - RIGHT;
    const [least, most] = EQUAL_HEIGHTS as Span;
    const high = Math.min(most, Math.max(least, (inner * (y[1] - y[0])) / (x[1] - x[0])));
    const unit = Math.min(inner / (x[1] - x[0]), high / (y[1] - y[0])); // px
    return { x: widened(x, inner / unit), y: widened(y, high / unit), height: high + TOP + BELOW };
  }
  private fit(): void {
    const width = this.holder.clientWidth;
    if (width === 0 || width === this.plot?.width) return;
    this.plot?.destroy();
    this.plot = this.make(width);
    this.recolour();
  }
  private recolour(): void {
    for (const { element, colour } of this.marks) element.style.setProperty("--colour", theme.colour(colour));
    this.plot?.redraw(false);
  }
  private make(width: number): uPlot {
    const { chart } = this;
    const names = chart.y_names;
    const { x: xs, y: ys, height } = this.axes(width);
    this.holder.style.height = `${height}px`;
    const x: uPlot.Axis = {
      ...AXIS,
      size: 38,
      gap: 2,
      label: chart.x_label,
      labelSize: 14,
      labelFont: "11px system-ui, sans-serif",
      ...(chart.x_log ? POWERS : {}),
    };
    const y: uPlot.Axis = {
      ...AXIS,
      size: names.length > 0 ? NAMES_WIDTH : NUMBERS_WIDTH,
      gap: 3,
      values: (_, at) => at.map(short),
      ...(chart.y_log ? POWERS : {}),
    };
    if (names.length > 0) {
      y.splits = () => names.map(([at]) => at);
      y.values = () => names.map(([, name]) => name);
    }
    const series = chart.series.filter((s) => s.style !== "path");
    return new uPlot(
      {
        width,
        height,
        padding: [TOP, RIGHT, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, distr: chart.x_log ? 3 : 1, range: xs },
          y: { distr: chart.y_log ? 3 : 1, range: ys, dir: names.length > 0 ? -1 : 1 },
        },
        axes: [x, y],
        series: [
          {},
          ...(series.length > 0
            ? series.map((s, i) => this.look(s, series.length - 1 - i))
            : [{ points: { show: false } }]),
        ],
        hooks: { drawAxes: [(u) => this.drawUnder(u)] },
      },
      columns(chart, series, xs) as uPlot.AlignedData,
      this.holder,
    );
  }
  private look(s: Series, behind: number): uPlot.Series {
    const colour = () => theme.colour(s.colour);
    const size = s.points.length > MANY ? 4 : 7;
    return {
      stroke: colour,
      width: s.style === "line" ? lineWidth(behind) : 0,
      spanGaps: true,
      points: { show: true, size, stroke: colour, fill: colour },
    };
  }

  private save(how: "png" | "svg"): void {
    if (!this.plot) return;
    const legend: Legend[] = [...this.chart.boxes, ...this.chart.series]
      .filter((s) => s.label)
      .map((s) => ({ label: s.label, colour: theme.colour(s.colour), dash: undefined }));
    if (how === "png") savePng(this.plot, this.title, legend);
    else saveSvg(this.plot, this.title, legend, (context) => this.drawSvg(this.plot!, context));
  }
  private drawSvg(u: uPlot, context: SvgContext): void {
    const { chart } = this;
    const at = ([x, y]: [number, number]): [number, number] => [u.valToPos(x, "x"), u.valToPos(y, "y")];
    if (chart.shades && this.shades) {
      const [left, right, bottom, top] = shadesIn(u, chart.shades, false);
      context.image(this.shades.toDataURL("image/png"), left, top, right - left, bottom - top);
    }
    for (const { colour, filled, boxes } of chart.boxes) {
      [context.fillStyle, context.strokeStyle, context.lineWidth] = [theme.colour(colour), theme.colour(colour), 2];
      for (const [x0, y0, x1, y1] of boxes) {
        const [[left, one], [right, other]] = [at([x0, y0]), at([x1, y1])];
        context.rectangle(left, Math.min(one, other), Math.max(1, right - left), Math.abs(one - other), filled);
      }
    }
    for (const series of chart.series) {
      const points = series.points.filter((p) => drawable(chart, p)).map(at);
      [context.fillStyle, context.strokeStyle, context.lineWidth] = [
        theme.colour(series.colour),
        theme.colour(series.colour),
        1.5,
      ];
      if (series.style !== "dots" && points.length > 1) context.line(points);
      if (series.style !== "path") for (const [x, y] of points) context.dot(x, y, points.length > MANY ? 2 : 3.5);
    }
  }

  // Beneath lines and dots.
  private drawUnder(u: uPlot): void {
    const { chart } = this;
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    if (chart.shades && this.shades) this.drawShades(u, chart.shades, this.shades);
    for (const boxes of chart.boxes) this.drawBoxes(u, boxes);
    const paths = chart.series.filter((s) => s.style === "path");
    // Without a name it is a help to the eye.
    paths.forEach((path, i) => this.drawPath(u, path, path.label ? lineWidth(paths.length - 1 - i) : 1));
    u.ctx.restore();
  }
  private drawShades(u: uPlot, shades: NonNullable<Chart["shades"]>, image: HTMLCanvasElement): void {
    const [left, right, bottom, top] = shadesIn(u, shades, true);
    u.ctx.imageSmoothingEnabled = false;
    u.ctx.drawImage(image, left, top, right - left, bottom - top);
  }
  private drawBoxes(u: uPlot, { colour, filled, boxes }: Chart["boxes"][number]): void {
    u.ctx.fillStyle = u.ctx.strokeStyle = theme.colour(colour);
    u.ctx.lineWidth = 2 * devicePixelRatio;
    for (const [x0, y0, x1, y1] of boxes) {
      const [left, right] = [u.valToPos(x0, "x", true), u.valToPos(x1, "x", true)];
      const [one, other] = [u.valToPos(y0, "y", true), u.valToPos(y1, "y", true)];
      if (filled) u.ctx.fillRect(left, Math.min(one, other), Math.max(1, right - left), Math.abs(one - other));
      else u.ctx.strokeRect(left, Math.min(one, other), right - left, Math.abs(one - other));
    }
  }
  private drawPath(u: uPlot, { colour, points }: Series, width: number): void {
    u.ctx.strokeStyle = theme.colour(colour);
    u.ctx.lineWidth = width * devicePixelRatio;
    u.ctx.lineJoin = "round";
    u.ctx.beginPath();
    for (const [x, y] of points) u.ctx.lineTo(u.valToPos(x, "x", true), u.valToPos(y, "y", true));
    u.ctx.stroke();
  }
}

/** Left, right, bottom and top of shades, px of the canvas or of the page within the axes. */
function shadesIn(
  u: uPlot,
  { min, max, count }: NonNullable<Chart["shades"]>,
  inCanvas: boolean,
): [number, number, number, number] {
  // Grid points are the middles of pixels.
  const half = [0, 1].map((axis) => (max[axis]! - min[axis]!) / (count[axis]! - 1) / 2);
  const [left, right] = [u.valToPos(min[0] - half[0]!, "x", inCanvas), u.valToPos(max[0] + half[0]!, "x", inCanvas)];
  const [bottom, top] = [u.valToPos(min[1] - half[1]!, "y", inCanvas), u.valToPos(max[1] + half[1]!, "y", inCanvas)];
  return [left, right, bottom, top];
}

/** Curves that agree lie on each other: those behind are wider. */
function lineWidth(behind: number): number {
  return Math.min(1.5 + 1.4 * behind, 6);
}

function holdsSomething({ series, boxes, shades }: Chart): boolean {
  return shades !== null || series.some((s) => s.points.length > 0) || boxes.some((b) => b.boxes.length > 0);
}

/** Charts that stand together under a title; null without any. */
export function chartsSection(
  title: string,
  some: Chart[],
  numbers: Numbers,
): { element: HTMLElement; figures: ChartFigure[] } | null {
  const shown = some.filter(holdsSomething);
  if (shown.length === 0) return null;
  // One scale for all shades, from zero, so that they compare.
  const shades = shown
    .flatMap((chart) => (chart.shades ? [...numbers.floats(chart.shades.values)] : []))
    .filter((v) => v > 0);
  const brightest = shades.reduce((most, v) => Math.max(most, v), 0) || 1;
  const figures = shown.map((chart) => new ChartFigure(chart, numbers, brightest));
  const element = h(
    "section",
    { class: "group" },
    h("h2", {}, title),
    h("div", { class: "grid" }, ...figures.map((figure) => figure.element)),
  );
  return { element, figures };
}

export function charts(report: ReportDocument, numbers: Numbers): { elements: HTMLElement[]; figures: ChartFigure[] } {
  const sections = report.charts.flatMap(({ title, charts: some }) => chartsSection(title, some, numbers) ?? []);
  return { elements: sections.map((s) => s.element), figures: sections.flatMap((s) => s.figures) };
}
