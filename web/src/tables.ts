// What was found, in words and tables, and where it comes from.
import { Bars } from "./bars";
import type { Motion, Provenance, ReportDocument, TableDocument } from "./document";
import { button, digits, h, scroller, typeset } from "./dom";
import { openVerdict } from "./verdict";

/** Of verdicts. */
const WORDS = new Set(["agrees", "differs", "step-dependent", "unresolved"]);

/** In a table of all pairs it opens that of its engines. */
function word(text: string, a: string, b: string): HTMLElement {
  const open = button(text, `${text}: ${a} and ${b}, open their verdict`, () => openVerdict(a, b));
  open.className = `word ${text}`;
  return open;
}

const SIGNS = { good: "\u2713", mixed: "\u25d0", bad: "\u2717", "": "" };

/** Whether a column of a table holds words, of more letters than units have: they stand left, and wrap. */
function isOfWords(rows: string[][], column: number): boolean {
  return rows.some((row) => /[A-Za-z]{4}/.test(row[column] ?? ""));
}

function table({ header, rows, marks, intervals, title }: TableDocument): HTMLElement {
  const wordy = header.map((_, column) => title !== "" && isOfWords(rows, column));
  const bars = intervals && new Bars(intervals.rows);
  const cells = (row: string[], tag: "th" | "td", at = -1) =>
    header.map((_, i) => {
      const text = row[i] ?? "";
      const mark = marks[at]?.[i] ?? "";
      return h(
        i === 0 ? "th" : tag,
        {
          scope: tag === "th" ? "col" : i === 0 ? "row" : false,
          class: [wordy[i] && "words", mark].filter(Boolean).join(" ") || false,
        },
        mark ? h("i", { class: "sign", "aria-hidden": "true" }, SIGNS[mark]) : null,
        WORDS.has(text) ? word(text, row[0]!, header[i]!) : typeset(text),
      );
    });
  const picture = (at: number) => (bars ? [h("td", { class: "picture" }, bars.picture(intervals.rows[at]!))] : []);
  const heads = bars ? [h("th", { scope: "col", class: "picture" }, intervals.label)] : [];
  const scale =
    bars &&
    h("tr", { class: "scale" }, h("td", { colspan: header.length }), h("td", { class: "picture" }, bars.scale()));
  return scroller(
    title || header[0] || "table",
    h(
      "table",
      {},
      h("thead", {}, h("tr", {}, ...cells(header, "th"), ...heads)),
      h("tbody", {}, ...rows.map((row, at) => h("tr", {}, ...cells(row, "td", at), ...picture(at))), scale),
    ),
  );
}

/** Tables that are part of the answer, each under its title. */
export function answers(report: ReportDocument): HTMLElement[] {
  return report.tables
    .filter(({ title }) => title !== "")
    .map((one) =>
      h(
        "section",
        { class: "group" },
        h("h2", {}, one.title),
        one.note ? h("p", {}, typeset(one.note)) : null,
        table(one),
      ),
    );
}

export function findings(report: ReportDocument, title: string): HTMLElement | null {
  const tables = report.tables.filter((one) => one.title === "");
  if (tables.length === 0 && report.sentences.length === 0 && report.texts.length === 0) return null;
  return h(
    "section",
    { class: "group" },
    h("h2", {}, title),
    ...tables.map(table),
    ...report.sentences.map((sentence) => h("p", {}, typeset(sentence))),
    ...report.texts.map((text) => h("pre", { class: "text", tabindex: 0 }, text)),
  );
}

/** Gait parameters that have no plot, since they never change. */
export function constants(motion: Motion): HTMLElement | null {
  if (motion.constants.length === 0) return null;
  const rows = motion.constants.map(({ name, unit, value }) => [name, unit, digits(value)]);
  return h(
    "section",
    { class: "group" },
    h(
      "details",
      {},
      h("summary", {}, "Gait parameters that never change"),
      table({ header: ["parameter", "unit", "value"], rows, title: "", note: "", marks: [], intervals: null }),
    ),
  );
}

// As it can be typed again.
function commandLine(p: Provenance): string {
  const words = [p.command ?? "", ...(p.arguments ?? [])].map((word) =>
    /^[\w.,:=/+@%-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`,
  );
  return `crossgait ${words.join(" ")}`;
}

export function origin(report: ReportDocument): HTMLElement {
  const parts = report.provenances.map((p) =>
    h(
      "div",
      { class: "origin" },
      h("code", {}, commandLine(p)),
      h(
        "p",
        {},
        `Crossgait ${p.crossgait ?? "?"}; ${(p.engines ?? []).map((e) => `${e.name} (${e.library} ${e.version})`).join(", ") || "no engine"}; hash ${p.hash ?? "?"}`,
      ),
      h(
        "details",
        {},
        h("summary", {}, "All that the result depends on"),
        h("pre", { tabindex: 0 }, JSON.stringify(p, null, 1)),
      ),
    ),
  );
  const note = report.provenances.length === 0 ? "Made from files that do not say how they came to be." : null;
  return h(
    "footer",
    {},
    h("h2", {}, "Where this comes from"),
    ...parts,
    note ? h("p", {}, note) : null,
    h(
      "p",
      { class: "muted" },
      `Page written by Crossgait ${report.crossgait}. SI units; angles in degrees where a plot says so. World frame: x forward, y left, z up.`,
    ),
  );
}
