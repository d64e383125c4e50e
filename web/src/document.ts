// What the page shows: the document that report/page.h describes, and the numbers that it refers to. The types down to
// ReportDocument are those of docs/schemas/report.json, which test/document.test.mjs holds them to.

/** Where numbers are, counted in numbers of four bytes. */
export interface Reference {
  at: number;
  count: number;
}

export interface Shape {
  type: "sphere" | "box" | "cylinder" | "capsule" | "mesh" | "hull";
  size: [number, number, number];
  position: [number, number, number];
  quaternion: [number, number, number, number];
  rgba: [number, number, number, number] | null;
  mesh?: number;
  scale?: [number, number, number];
  vertices?: Reference;
}

export interface Ground {
  columns: number;
  rows: number;
  x: number;
  y: number;
  cell_x: number;
  cell_y: number;
  heights: Reference;
}

export interface Scene {
  robot: string;
  terrain: string;
  standing_height: number;
  reach: number;
  path: [number, number, number, number];
  bodies: {
    name: string;
    mass: number;
    centre_of_mass: [number, number, number];
    shapes: Shape[];
    /** What collides. */
    collision: Shape[];
    /** A box of even density with its mass and moments. */
    inertia: Shape;
  }[];
  meshes: { vertices: Reference; triangles: Reference }[];
  legs: {
    name: string;
    body: number;
    foot: [number, number, number];
    radius: number;
    origin: [number, number, number] | null;
  }[];
  ground: Ground | null;
  notes: string[];
}

export interface RunDocument {
  name: string;
  engine: string;
  time: Reference;
  poses: Reference;
  feet: Reference;
  forces: Reference;
  force_directions: boolean;
  outcome: string;
  outcome_at_s: number | null;
  contact: number[][] | null;
  planned: number[][] | null;
}

export interface Pair {
  a: number;
  b: number;
  same: boolean;
  parting: { standing_m: number; time_s: number | null };
}

export interface Panel {
  group: "base" | "feet" | "joints" | "parameters" | "rewards" | "differences";
  title: string;
  unit: string;
  log: boolean;
  leg?: string;
  series: { run: number; other?: number; label: string; dashed: boolean; values: Reference }[];
}

export interface Motion {
  name: string;
  side_by_side: boolean;
  scene: Scene;
  runs: RunDocument[];
  pairs: Pair[];
  panels: Panel[];
  constants: { name: string; unit: string; value: number }[];
  shortest_contact: number;
  notes: string[];
}

/** What a page that shows runs live says besides. */
export interface Live {
  /** Force on a foot that is drawn as long as a leg, N; otherwise that which is usual in the runs. */
  usual_load?: number;
  /** The ground is a plane that goes along with the robot. */
  endless?: boolean;
  /** Whether runs go on while they are shown. */
  live?: boolean;
}

export interface Interval {
  estimate: number;
  low: number;
  high: number;
}

/** One pair of engines of a verdict. */
export interface Verdict {
  behaviour: string;
  starts: number;
  confidence: number;
  variations: string[];
  left_out: string[];
  engines: [string, string];
  word: "agrees" | "differs" | "step-dependent" | "unresolved";
  reason: string;
  outcomes: [string, string];
  statistics: {
    name: string;
    unit: string;
    values: [number, number];
    estimand: string;
    gap: number;
    low: number;
    high: number;
    margin: number;
    margin_rule: string;
    word: "agrees" | "differs" | "step-dependent" | "unresolved";
    reason: string;
    gap_half: number | null;
  }[];
  models: { quantity: string; element: string; a: number; b: number; unit: string }[];
  attribution: {
    from: string;
    to: string;
    statistics: {
      name: string;
      unit: string;
      gap: Interval;
      leading: string[];
      sentence: string;
      groups: { name: string; effect: Interval }[];
    }[];
    factors: { name: string; group: string; summary: string }[];
  } | null;
}

export interface Chart {
  title: string;
  x_label: string;
  y_label: string;
  x_log: boolean;
  y_log: boolean;
  y_names: [number, string][];
  equal_scales: boolean;
  series: { label: string; colour: number; style: "dots" | "line" | "path"; points: [number, number][] }[];
  boxes: { label: string; colour: number; filled: boolean; boxes: [number, number, number, number][] }[];
  shades: {
    label: string;
    min: [number, number];
    max: [number, number];
    count: [number, number];
    values: Reference;
  } | null;
}

export interface Charts {
  title: string;
  charts: Chart[];
}

export interface Provenance {
  crossgait?: string;
  command?: string;
  arguments?: string[];
  engines?: { name: string; library: string; version: string }[];
  hash?: string;
  [key: string]: unknown;
}

export interface TableDocument {
  title: string;
  note: string;
  header: string[];
  rows: string[][];
  marks: ("" | "good" | "mixed" | "bad")[][];
  intervals: { label: string; rows: (Interval | null)[] } | null;
}

export interface ReportDocument {
  schema: { name: "report"; version: "draft" };
  title: string;
  crossgait: string;
  summary: string;
  groups: string[];
  sentences: string[];
  motions: Motion[];
  tables: TableDocument[];
  charts: Charts[];
  texts: string[];
  verdicts: Verdict[];
  provenances: Provenance[];
}

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

function bytesOf(base64: string): ArrayBuffer {
  // Browsers from 2025 on do it at once.
  const native = (Uint8Array as { fromBase64?: (text: string) => Uint8Array<ArrayBuffer> }).fromBase64;
  if (native) return native(base64).buffer;
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

/** The numbers of the page, without a copy. */
export class Numbers {
  private readonly bytes: ArrayBuffer;

  /** @param base64 by default those in the page */
  constructor(base64 = textOf("numbers")) {
    this.bytes = bytesOf(base64);
  }

  floats(where: Reference): Float32Array {
    return new Float32Array(this.bytes, 4 * where.at, where.count);
  }
  indices(where: Reference): Uint32Array {
    return new Uint32Array(this.bytes, 4 * where.at, where.count);
  }
}

/** One run with its numbers at hand. */
export class Run {
  readonly name: string;
  readonly time: Float32Array;
  readonly poses: Float32Array;
  readonly feet: Float32Array;
  readonly forces: Float32Array;

  constructor(
    readonly index: number,
    readonly document: RunDocument,
    numbers: Numbers,
  ) {
    this.name = document.name;
    this.time = numbers.floats(document.time);
    this.poses = numbers.floats(document.poses);
    this.feet = numbers.floats(document.feet);
    this.forces = numbers.floats(document.forces);
  }

  /** The last frame that is not after `time`, or the first. */
  frameAt(time: number): number {
    let low = 0;
    let high = this.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      // Half a microsecond: times are floats.
      if ((this.time[middle] as number) <= time + 5e-7) low = middle;
      else high = middle - 1;
    }
    return low;
  }
}

/** Of a page that a server gave out to watch a robot live. */
export interface LiveDocument {
  live: true;
  crossgait: string;
}

export function readDocument(): ReportDocument | LiveDocument {
  return JSON.parse(textOf("document")) as ReportDocument | LiveDocument;
}
