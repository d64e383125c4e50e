// Figures as files: a picture as PNG, a plot as PNG or SVG.
import type uPlot from "uplot";
import { button, h } from "./dom";
import { theme } from "./theme";

const FONT = "system-ui, sans-serif";
const CAPTION = 24; // px

function save(address: string, name: string, ending: string): void {
  const link = document.createElement("a");
  link.href = address;
  link.download = `${name.replace(/[^\w.,-]+/g, " ").trim()}.${ending}`;
  link.click();
}

export function saveImage(canvas: HTMLCanvasElement, name: string): void {
  save(canvas.toDataURL("image/png"), name, "png");
}

/** For a figure's caption. */
export function saveButtons(act: (how: "png" | "svg") => void): HTMLElement {
  return h(
    "span",
    { class: "save" },
    ...(["png", "svg"] as const).map((how) =>
      button(how, `${how}: save this figure as ${how.toUpperCase()}`, () => act(how)),
    ),
  );
}

/** A name in a figure's legend. */
export interface Legend {
  label: string;
  colour: string;
  dash: number[] | undefined;
}

/** The plot as it is drawn, under its title, on the page's ground. */
export function savePng(u: uPlot, title: string, legend: Legend[]): void {
  const source = u.ctx.canvas;
  const scale = source.width / u.width;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [source.width, source.height + 2 * CAPTION * scale];
  const context = canvas.getContext("2d")!;
  context.fillStyle = theme.variable("--card");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.scale(scale, scale);
  context.fillStyle = theme.variable("--text");
  context.font = `bold 12px ${FONT}`;
  context.fillText(title, 8, 16);
  context.font = `11px ${FONT}`;
  let x = 8;
  for (const { label, colour, dash } of legend) {
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.setLineDash(dash ?? []);
    context.beginPath();
    context.moveTo(x, CAPTION + 9);
    context.lineTo(x + 18, CAPTION + 9);
    context.stroke();
    context.fillText(label, x + 22, CAPTION + 13);
    x += 34 + context.measureText(label).width;
  }
  context.drawImage(source, 0, 2 * CAPTION, u.width, source.height / scale);
  saveImage(canvas, title);
}

/** Writes what uPlot draws on a canvas as elements of SVG: lines, rectangles, dots and words. */
class SvgContext {
  readonly elements: string[] = [];
  fillStyle = "#000";
  strokeStyle = "#000";
  lineWidth = 1;
  dash: number[] = [];

  line(points: [number, number][]): void {
    const at = points.map(([x, y]) => `${+x.toFixed(2)},${+y.toFixed(2)}`).join(" ");
    const dash = this.dash.length > 0 ? ` stroke-dasharray="${this.dash.join(" ")}"` : "";
    this.elements.push(
      `<polyline points="${at}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"${dash} stroke-linejoin="round"/>`,
    );
  }
  rectangle(x: number, y: number, width: number, height: number, filled = true): void {
    const look = filled
      ? `fill="${this.fillStyle}"`
      : `fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`;
    this.elements.push(
      `<rect x="${+x.toFixed(2)}" y="${+y.toFixed(2)}" width="${+width.toFixed(2)}" height="${+height.toFixed(2)}" ${look}/>`,
    );
  }
  image(address: string, x: number, y: number, width: number, height: number): void {
    this.elements.push(
      `<image href="${address}" x="${x}" y="${y}" width="${width}" height="${height}" preserveAspectRatio="none" style="image-rendering: pixelated"/>`,
    );
  }
  dot(x: number, y: number, radius: number): void {
    this.elements.push(`<circle cx="${+x.toFixed(2)}" cy="${+y.toFixed(2)}" r="${radius}" fill="${this.fillStyle}"/>`);
  }
  words(text: string, x: number, y: number, anchor: "start" | "middle" | "end", bold = false): void {
    const plain = text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
    const weight = bold ? ' font-weight="bold"' : "";
    this.elements.push(
      `<text x="${+x.toFixed(2)}" y="${+y.toFixed(2)}" font-family="${FONT}" font-size="11" text-anchor="${anchor}" fill="${this.fillStyle}"${weight}>${plain}</text>`,
    );
  }
}
export type { SvgContext };

/** Where the ticks of an axis are, and what they say. */
function ticks(u: uPlot, axis: number): [number, string][] {
  const { _splits: at, _values: words } = u.axes[axis] as unknown as { _splits: number[]; _values: (string | null)[] };
  return (at ?? []).flatMap((value, i): [number, string][] => (words?.[i] ? [[value, String(words[i])]] : []));
}

/** @param draw  what lies within the axes, in the plot's own px (`u.valToPos`), the axes' corner at 0, 0 */
export function saveSvg(u: uPlot, title: string, legend: Legend[], draw: (context: SvgContext) => void): void {
  save(`data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgOf(u, title, legend, draw))}`, title, "svg");
}

export function svgOf(u: uPlot, title: string, legend: Legend[], draw: (context: SvgContext) => void): string {
  const over = u.over;
  const [left, top, width, height] = [
    over.offsetLeft,
    over.offsetTop + 2 * CAPTION,
    over.clientWidth,
    over.clientHeight,
  ];
  const [frame, inner] = [new SvgContext(), new SvgContext()];
  frame.fillStyle = theme.variable("--card");
  frame.rectangle(0, 0, u.width, u.height + 2 * CAPTION);
  frame.fillStyle = theme.variable("--text");
  frame.words(title, 8, 16, "start", true);
  let x = 8;
  for (const { label, colour, dash } of legend) {
    [frame.strokeStyle, frame.lineWidth, frame.dash] = [colour, 2, dash ?? []];
    frame.line([
      [x, CAPTION + 9],
      [x + 18, CAPTION + 9],
    ]);
    frame.words(label, x + 22, CAPTION + 13, "start");
    x += 34 + 6.2 * label.length; // about
  }
  [frame.strokeStyle, frame.lineWidth, frame.dash] = [theme.variable("--rule"), 1, []];
  frame.fillStyle = theme.variable("--muted");
  for (const [value, words] of ticks(u, 0)) {
    const at = left + u.valToPos(value, "x");
    frame.line([
      [at, top],
      [at, top + height],
    ]);
    frame.words(words, at, top + height + 15, "middle");
  }
  for (const [value, words] of ticks(u, 1)) {
    const at = top + u.valToPos(value, "y");
    frame.line([
      [left, at],
      [left + width, at],
    ]);
    frame.words(words, left - 5, at + 4, "end");
  }
  draw(inner);
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${u.width}" height="${u.height + 2 * CAPTION}">`,
    ...frame.elements,
    `<clipPath id="within"><rect width="${width}" height="${height}"/></clipPath>`,
    `<g transform="translate(${left} ${top})"><g clip-path="url(#within)">`,
    ...inner.elements,
    "</g></g></svg>",
  ].join("\n");
}
