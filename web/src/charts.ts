// Curves and dots over any axis: what benchmarks and searches found.
import uPlot from "uplot";
import type { Chart, ReportDocument } from "./document";
import { h } from "./dom";
import { AXIS, POWERS, short } from "./plots";
import { theme } from "./theme";

const HEIGHT = 240; // px
const NAMES_WIDTH = 110; // px

type Column = (number | null)[];

function drawable(chart: Chart, [x, y]: [number, number]): boolean {
  return (!chart.x_log || x > 0) && (!chart.y_log || y > 0);
}

/** One ascending column of x, and each series on it. */
function columns(chart: Chart): Column[] {
  const tables = chart.series.map((s): uPlot.AlignedData => {
    const points = s.points.filter((p) => drawable(chart, p));
    // Two dots at one x stay two.
    return [
      points.map(([x], i) => (i > 0 && points[i - 1]![0] === x ? x * (1 + 1e-12 * i) + 1e-300 : x)),
      points.map(([, y]) => y),
    ];
  });
  return tables.length === 1 ? (tables[0] as Column[]) : (uPlot.join(tables) as Column[]);
}

/** Room around dots, so that none lies on the frame. */
function range(log: boolean): uPlot.Scale.Range {
  return (_u, low, high) => {
    if (!Number.isFinite(low) || !Number.isFinite(high)) return log ? [1e-3, 1] : [0, 1];
    if (log) return [low / 1.6, high * 1.6];
    const room = 0.06 * (high - low || Math.abs(high) || 1);
    return [low >= 0 && low < 0.5 * high ? 0 : low - room, high + room];
  };
}

class ChartFigure {
  readonly element: HTMLElement;
  private readonly holder = h("div", { class: "plot" });
  private readonly marks: HTMLElement[];
  private plot: uPlot | null = null;

  constructor(private readonly chart: Chart) {
    this.marks = chart.series.map((s) => h("span", { class: "key" }, h("i", { class: "mark" }), s.label));
    const title = [chart.title, chart.y_label].filter(Boolean).join(": ");
    const keys = chart.series.some((s) => s.label) ? this.marks : [];
    this.element = h(
      "figure",
      { class: "panel" },
      h("figcaption", {}, h("b", {}, title), h("span", { class: "keys" }, ...keys)),
      this.holder,
    );
    this.holder.style.height = `${this.height}px`;
    theme.onChange(() => this.recolour());
    new ResizeObserver(() => this.fit()).observe(this.holder);
  }

  /** The x and y of every dot that is drawn, series by series. */
  get points(): [number, number][][] {
    return this.chart.series.map((s) => s.points.filter((p) => drawable(this.chart, p)));
  }

  private get height(): number {
    return Math.max(HEIGHT, 60 + 34 * this.chart.y_names.length);
  }
  private fit(): void {
    const width = this.holder.clientWidth;
    if (width === 0) return;
    if (!this.plot) {
      this.plot = this.make(width);
      this.recolour();
    } else if (width !== this.plot.width) {
      this.plot.setSize({ width, height: this.height });
    }
  }
  private recolour(): void {
    this.marks.forEach((mark, i) => mark.style.setProperty("--colour", theme.colour(this.chart.series[i]!.colour)));
    this.plot?.redraw(false);
  }
  private make(width: number): uPlot {
    const { chart } = this;
    const names = chart.y_names;
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
      size: names.length > 0 ? NAMES_WIDTH : 56,
      gap: 3,
      values: (_, at) => at.map(short),
      ...(chart.y_log ? POWERS : {}),
    };
    if (names.length > 0) {
      y.splits = () => names.map(([at]) => at);
      y.values = () => names.map(([, name]) => name);
    }
    const rows = names.map(([at]) => at);
    return new uPlot(
      {
        width,
        height: this.height,
        padding: [8, 18, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, distr: chart.x_log ? 3 : 1, range: range(chart.x_log) },
          y: {
            distr: chart.y_log ? 3 : 1,
            range: names.length > 0 ? [Math.min(...rows) - 0.6, Math.max(...rows) + 0.6] : range(chart.y_log),
            dir: names.length > 0 ? -1 : 1,
          },
        },
        axes: [x, y],
        series: [
          {},
          ...chart.series.map((s): uPlot.Series => {
            const colour = () => theme.colour(s.colour);
            return {
              stroke: colour,
              width: s.line ? 1.5 : 0,
              spanGaps: true,
              points: { show: true, size: 7, stroke: colour, fill: colour },
            };
          }),
        ],
      },
      columns(chart) as uPlot.AlignedData,
      this.holder,
    );
  }
}

export function charts(report: ReportDocument): { elements: HTMLElement[]; figures: ChartFigure[] } {
  const figures: ChartFigure[] = [];
  const elements = report.charts.map(({ title, charts: some }) => {
    const own = some
      .filter((chart) => chart.series.some((s) => s.points.length > 0))
      .map((chart) => new ChartFigure(chart));
    figures.push(...own);
    return h(
      "section",
      { class: "group" },
      h("h2", {}, title),
      h("div", { class: "grid" }, ...own.map((figure) => figure.element)),
    );
  });
  return { elements, figures };
}
