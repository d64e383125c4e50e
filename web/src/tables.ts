// What was found, in words and tables, and where it comes from.
import type { Motion, Provenance, ReportDocument } from "./document";
import { button, digits, h } from "./dom";
import { openVerdict } from "./verdict";

/** Of verdicts. */
const WORDS = new Set(["agrees", "differs", "step-dependent", "unresolved"]);

/** In a table of all pairs it opens that of its engines. */
function word(text: string, a: string, b: string): HTMLElement {
  const open = button(text, `${text}: ${a} and ${b}, open their verdict`, () => openVerdict(a, b));
  open.className = `word ${text}`;
  return open;
}

function table(header: string[], rows: string[][]): HTMLElement {
  const cells = (row: string[], tag: "th" | "td") =>
    row.map((text, i) =>
      h(
        i === 0 ? "th" : tag,
        { scope: tag === "th" ? "col" : i === 0 ? "row" : false },
        WORDS.has(text) ? word(text, row[0]!, header[i]!) : text,
      ),
    );
  return h(
    "div",
    { class: "scroll" },
    h(
      "table",
      {},
      h("thead", {}, h("tr", {}, ...cells(header, "th"))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...cells(row, "td")))),
    ),
  );
}

export function findings(report: ReportDocument, title: string): HTMLElement | null {
  if (report.tables.length === 0 && report.sentences.length === 0 && report.texts.length === 0) return null;
  return h(
    "section",
    { class: "group" },
    h("h2", {}, title),
    ...report.tables.map(({ header, rows }) => table(header, rows)),
    ...report.sentences.map((sentence) => h("p", {}, sentence)),
    ...report.texts.map((text) => h("pre", { class: "text" }, text)),
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
      table(["parameter", "unit", "value"], rows),
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
      h("details", {}, h("summary", {}, "All that the result depends on"), h("pre", {}, JSON.stringify(p, null, 1))),
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
