// The page: what the document holds, laid out and wired together.
import { charts, type ChartFigure } from "./charts";
import { Numbers, readDocument, type ReportDocument } from "./document";
import { button, h, typeset } from "./dom";
import { LivePage } from "./live";
import { Replays } from "./replay";
import "./style.css";
import { answers, findings, origin } from "./tables";
import { theme } from "./theme";
import { verdictSection } from "./verdict";

const KEYS: [string, string][] = [
  ["space", "play, pause"],
  ["\u2190 \u2192", "one frame (with shift: ten)"],
  ["Home End", "begin, end"],
  ["[ ]", "slower, faster"],
  ["1 2 3 4", "three-quarter, side, front, top"],
  ["w a s d + \u2212", "turn, zoom"],
  ["f b p", "follow, side by side, to the first mark"],
  ["t", "light, dark"],
];

function header(report: ReportDocument): HTMLElement {
  const { motions } = report;
  const [motion] = motions;
  const facts =
    motions.length > 1
      ? `${motion!.scene.robot} \u00b7 ${motions.length} replays`
      : motion
        ? `${motion.scene.robot} on ${motion.scene.terrain} \u00b7 ${motion.runs.map((run) => (run.engine ? `${run.name} (${run.engine})` : run.name)).join(", ")}`
        : report.verdicts.length > 1
          ? `${new Set(report.verdicts.flatMap((v) => v.engines)).size} engines`
          : report.verdicts.map((v) => `${v.engines.join(" and ")}: ${v.word}`).join(", ");
  const keys = h(
    "details",
    { class: "help" },
    h("summary", {}, "keys"),
    h("dl", {}, ...KEYS.flatMap(([k, what]) => [h("dt", {}, k), h("dd", {}, what)])),
  );
  return h(
    "header",
    {},
    h("h1", {}, report.title),
    h("p", {}, facts),
    h(
      "span",
      { class: "right" },
      motion ? keys : null,
      button("\u25d0", "Light or dark (t)", () => theme.toggle()),
    ),
    answer(report),
  );
}

/** What was found, and which engines did the same. */
function answer(report: ReportDocument): HTMLElement | null {
  if (!report.summary) return null;
  const groups = report.groups.length > 1 ? report.groups : [];
  return h(
    "div",
    { class: "answer" },
    h("p", {}, typeset(report.summary)),
    groups.length > 0 ? h("ul", {}, ...groups.map((line) => h("li", {}, typeset(line)))) : null,
  );
}

/** On paper nothing can be opened. */
function openForPrint(): void {
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll<HTMLDetailsElement>(".verdict details, .notes"))
      details.open = true;
  });
}

function listen(replays: Replays | null): void {
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || target instanceof HTMLSelectElement) return;
    // A button that has the focus is pressed by space, as everywhere.
    if (event.key === " " && target.closest("button, input[type=checkbox], summary")) return;
    if (event.key === "t") theme.toggle();
    else if (replays?.current.stage.press(event.key, event.shiftKey)) event.preventDefault();
  });
}

/** For tests, and for those who want more of the numbers: the browser's console has them all. */
class Handles {
  constructor(
    readonly report: ReportDocument,
    readonly replays: Replays | null,
    readonly charts: ChartFigure[],
  ) {}
  get runs() {
    return this.replays?.current.runs;
  }
  get player() {
    return this.replays?.current.player;
  }
  get view() {
    return this.replays?.current.stage.view;
  }
  get plots() {
    return this.replays?.current.plots;
  }
  get feet() {
    return this.replays?.current.feet;
  }
}

function buildReport(report: ReportDocument): object {
  document.title = `${report.title} \u2013 Crossgait`;
  const page = document.getElementById("page")!;
  const head = header(report);
  page.append(head);
  // What is beside the plots is in sight as a whole before anybody scrolls.
  new ResizeObserver(() => page.style.setProperty("--head", `${head.offsetHeight}px`)).observe(head);
  const results = h("div", { class: "results" });
  const found = answers(report);
  if (found.length > 0) page.append(h("div", { class: "answers" }, ...found));
  page.append(results);
  const numbers = new Numbers();
  const replayed = report.motions.length > 0;
  if (replayed) page.classList.add("replay");
  const replays = replayed ? new Replays(report.motions, numbers, page, results) : null;
  // Of a verdict first what it comes to, then every pair.
  const judged = !replays && report.verdicts.length > 0;
  const rest = findings(
    report,
    judged ? (report.verdicts.length > 1 ? "Which engines agree" : "Verdict") : replays ? "Statistics" : "Numbers",
  );
  if (rest && judged) results.append(rest);
  for (const verdict of report.verdicts) results.append(verdictSection(verdict, report.verdicts.length > 1));
  const drawn = charts(report, numbers);
  results.append(...drawn.elements);
  if (rest && !judged) results.append(rest);
  results.append(origin(report));
  listen(replays);
  openForPrint();
  return new Handles(report, replays, drawn.figures);
}

const shown = readDocument();
Object.assign(window, { crossgait: "live" in shown ? new LivePage(shown) : buildReport(shown) });
