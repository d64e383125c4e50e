// The page: what the document holds, laid out and wired together.
import { charts, chartsSection } from "./charts";
import { Numbers, readDocument, Run, type ReportDocument } from "./document";
import { button, h } from "./dom";
import { footPaths } from "./feet";
import { LivePage } from "./live";
import { Player } from "./player";
import { Permalink } from "./permalink";
import { Plots } from "./plots";
import { Stage } from "./stage";
import "./style.css";
import { constants, findings, origin } from "./tables";
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
  const { motion } = report;
  const facts = motion
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
    h("p", {}, report.summary),
    groups.length > 0 ? h("ul", {}, ...groups.map((line) => h("li", {}, line))) : null,
  );
}

/** On paper nothing can be opened. */
function openForPrint(): void {
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll<HTMLDetailsElement>(".verdict details")) details.open = true;
  });
}

function listen(stage: Stage | null): void {
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || target instanceof HTMLSelectElement) return;
    // A button that has the focus is pressed by space, as everywhere.
    if (event.key === " " && target.closest("button, input[type=checkbox], summary")) return;
    if (event.key === "t") theme.toggle();
    else if (stage?.press(event.key, event.shiftKey)) event.preventDefault();
  });
}

function buildReport(report: ReportDocument): object {
  document.title = `${report.title} \u2013 Crossgait`;
  const page = document.getElementById("page")!;
  const head = header(report);
  page.append(head);
  // What is beside the plots is in sight as a whole before anybody scrolls.
  new ResizeObserver(() => page.style.setProperty("--head", `${head.offsetHeight}px`)).observe(head);
  const { motion } = report;
  const results = h("div", { class: "results" });
  let stage: Stage | null = null;
  let handles: object = { report };
  const numbers = new Numbers();
  if (motion) {
    const runs = motion.runs.map((run, index) => new Run(index, run, numbers));
    const longest = runs.reduce((a, b) => (b.time[b.time.length - 1]! > a.time[a.time.length - 1]! ? b : a));
    const player = new Player(longest.time);
    page.classList.add("replay");
    theme.setRuns(runs.map((run) => run.name));
    stage = new Stage(motion, runs, numbers, player);
    const plots = new Plots(motion, runs, numbers, player);
    page.append(stage.element, results);
    new Permalink(stage, player, runs);
    const feet = chartsSection("Paths of the feet in the leg frames", footPaths(motion, runs), numbers)!;
    results.append(plots.element, feet.element, ...[constants(motion)].filter((e) => e !== null));
    const notes = [...motion.notes, ...motion.scene.notes];
    if (notes.length > 0)
      results.append(
        h(
          "section",
          { class: "group" },
          h("h2", {}, "Rendering notes"),
          h("ul", {}, ...notes.map((note) => h("li", {}, note))),
        ),
      );
    handles = { report, runs, player, view: stage.view, plots, feet: feet.figures };
  } else {
    page.append(results);
  }
  // Of a verdict first what it comes to, then every pair.
  const judged = !motion && report.verdicts.length > 0;
  const found = findings(
    report,
    judged ? (report.verdicts.length > 1 ? "Which engines agree" : "Verdict") : motion ? "Statistics" : "Numbers",
  );
  if (found && judged) results.append(found);
  for (const verdict of report.verdicts) results.append(verdictSection(verdict, report.verdicts.length > 1));
  const drawn = charts(report, numbers);
  results.append(...drawn.elements);
  if (found && !judged) results.append(found);
  results.append(origin(report));
  listen(stage);
  openForPrint();
  return { ...handles, charts: drawn.figures };
}

// For tests, and for those who want more of the numbers: the browser's console has them all.
const shown = readDocument();
Object.assign(window, { crossgait: "live" in shown ? new LivePage(shown) : buildReport(shown) });
