// A robot that is live, as the replay shows runs: its last frames, of which the last is now.
import type { Run, RunDocument } from "./document";
import type { LiveRobot } from "./live_link";

/** As many as a foot's path behind it takes. */
const FRAMES = 64;

export class LiveRun implements Run {
  readonly name: string;
  readonly document: RunDocument;
  readonly time = new Float32Array(FRAMES);
  readonly poses: Float32Array;
  readonly feet: Float32Array;
  readonly forces: Float32Array;

  constructor(
    readonly index: number,
    robot: LiveRobot,
  ) {
    const nowhere = { at: 0, count: 0 };
    this.name = robot.engine;
    this.document = {
      name: robot.engine,
      engine: "",
      time: nowhere,
      poses: nowhere,
      feet: nowhere,
      forces: nowhere,
      force_directions: true,
      outcome: "",
      outcome_at_s: null,
      contact: null,
      planned: null,
    };
    this.poses = new Float32Array(FRAMES * robot.poses.length);
    this.feet = new Float32Array(FRAMES * robot.feet.length);
    this.forces = new Float32Array(FRAMES * robot.forces.length);
    this.begin(robot);
  }

  add(robot: LiveRobot): void {
    // Put back to the start, it leaves no path across the ground.
    if (robot.time < this.time[FRAMES - 1]!) return this.begin(robot);
    if (robot.time === this.time[FRAMES - 1]) return;
    const push = (list: Float32Array, values: ArrayLike<number>) => {
      list.copyWithin(0, values.length);
      list.set(values, list.length - values.length);
    };
    push(this.time, [robot.time]);
    push(this.poses, robot.poses);
    push(this.feet, robot.feet);
    push(this.forces, robot.forces);
  }

  /** Now, whatever the time. */
  frameAt(_time: number): number {
    return FRAMES - 1;
  }

  private begin(robot: LiveRobot): void {
    for (let i = 0; i < FRAMES; ++i) {
      this.poses.set(robot.poses, i * robot.poses.length);
      this.feet.set(robot.feet, i * robot.feet.length);
      this.forces.set(robot.forces, i * robot.forces.length);
    }
    this.time.fill(robot.time);
  }
}
