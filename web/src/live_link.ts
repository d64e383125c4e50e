// What a live page gets from its server, and sends to it (view/session.h, view/command.h).
import type { Scene } from "./document";

export interface LiveOptions {
  /** Revision of what is driven. */
  subject: number;
  /** Names that may be chosen. */
  robots: string[];
  policies: string[];
  /** Name or file of the robot that there is. */
  robot: string;
  engines: string[];
  most_engines: number;
  gaits: { name: string; summary: string }[];
  parameters: { name: string; unit: string; help: string; min: number; max: number }[];
  /** Of the swing. */
  curves: string[];
  terrains: { name: string; help: string }[];
  limits: { forward: number; left: number; yaw_rate: number; push: number };
  mass: number;
  /** Names of servos, in the order of angles, speeds and torques. */
  joints: string[];
  /** What of the world may be changed under way. */
  quantities: LiveQuantity[];
  /** What drives beside the hand, if anything does. */
  policy: string | null;
}

export interface LiveQuantity {
  name: string;
  unit: string;
  help: string;
  /** Whether it is changed by a factor. */
  factor: boolean;
  min: number;
  max: number;
  value: number;
}

export interface LiveScene {
  revision: number;
  scene: Scene;
  numbers: string;
}

export interface LiveRobot {
  engine: string;
  law: string;
  outcome: string;
  time: number;
  poses: number[];
  feet: number[];
  forces: number[];
  contact: boolean[];
  swing: boolean[];
  velocity: [number, number, number];
  roll: number;
  pitch: number;
  height: number;
  angles: number[];
  speeds: number[];
  torques: number[];
  /** From the first robot, m and rad. */
  gap: number;
  turned: number;
}

export interface Velocity {
  vx: number;
  vy: number;
  yaw_rate: number;
}

export interface LiveFrame {
  number: number;
  subject: number;
  scene: number;
  paused: boolean;
  pace: number;
  /** Seconds that can be gone back. */
  back: number;
  changes: string[];
  /** The point that pulls at the base, if one does. */
  pull: [number, number, number] | null;
  /** Of its spring, N. */
  pull_force: number;
  rate: number;
  /** These five are null where a policy commands joints. What was chosen may be "auto"; the gait is what walks. */
  chosen: string | null;
  gait: string | null;
  curve: string | null;
  phase: number | null;
  parameters: number[] | null;
  command: Velocity;
  terrain: string;
  seed: number;
  recorded: number | null;
  reports: number;
  robots: LiveRobot[];
}

export type Command =
  | ({ do: "drive" } & Velocity)
  | { do: "gait"; gait: string }
  | { do: "set"; name: string; value: number }
  | { do: "curve"; curve: string }
  | { do: "push"; impulse: [number, number, number] }
  | { do: "terrain"; terrain: string; seed: number }
  | { do: "engines"; engines: string[] }
  | { do: "robot"; robot: string }
  | { do: "policy"; policy: string }
  | { do: "pause"; on: boolean }
  | { do: "step"; steps: number }
  | { do: "pace"; pace: number }
  | { do: "back"; seconds: number }
  | { do: "change"; changes: string[] }
  | { do: "pull"; to: [number, number, number] }
  | { do: "release" }
  | { do: "keep" }
  | { do: "stand" }
  | { do: "record"; on: boolean };

/** Everything is below the page's own address, which holds the token. */
export class Link {
  private stream: EventSource | null = null;
  /** Of each kind, what is to be sent when the one before has arrived: a slider says more than a server needs. */
  private readonly waiting = new Map<string, Command>();
  private readonly busy = new Set<string>();

  constructor(
    private readonly frame: (frame: LiveFrame) => void,
    /** Told what went wrong; an empty text once it is well again. */
    private readonly trouble: (words: string) => void,
  ) {}

  options(): Promise<LiveOptions> {
    return this.get<LiveOptions>("options");
  }
  scene(): Promise<LiveScene> {
    return this.get<LiveScene>("scene");
  }
  watch(): void {
    this.stream = new EventSource("frames");
    this.stream.onmessage = (event) => this.frame(JSON.parse(event.data as string) as LiveFrame);
    this.stream.onopen = () => this.trouble("");
    // The browser tries again by itself.
    this.stream.onerror = () => this.trouble("no connection: crossgait view has ended, or as many look on as may");
  }
  close(): void {
    this.stream?.close();
  }

  send(command: Command): void {
    // A release has to come after the last pull.
    const kind = command.do === "set" ? `set ${command.name}` : command.do === "release" ? "pull" : command.do;
    // Pushes, steps and ways back add up; of everything else the last one counts.
    if (["push", "step", "back"].includes(command.do) || !this.busy.has(kind)) void this.post(kind, command);
    else this.waiting.set(kind, command);
  }

  /** Files that were dropped, by their paths: what is driven from then on. */
  async drop(files: [string, File][]): Promise<void> {
    const body = new FormData();
    for (const [path, file] of files) body.append(path, file, file.name);
    await this.answer("drop", { method: "POST", body });
  }

  private async get<T>(path: string): Promise<T> {
    const answer = await fetch(path);
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return (await answer.json()) as T;
  }
  private async post(kind: string, command: Command): Promise<void> {
    this.busy.add(kind);
    await this.answer("command", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(command),
    });
    this.busy.delete(kind);
    const next = this.waiting.get(kind);
    this.waiting.delete(kind);
    if (next) void this.post(kind, next);
  }
  /** Says what is wrong with what was asked, if anything is. */
  private async answer(path: string, request: RequestInit): Promise<void> {
    try {
      const answer = await fetch(path, request);
      this.trouble(answer.ok ? "" : (await answer.text()).trim());
    } catch {
      this.trouble("no connection");
    }
  }
}
