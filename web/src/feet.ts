// Paths of the feet beside the robot, as charts: where each went in its leg's frame, seen from the side.
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Chart, Motion, Run } from "./document";
import { theme } from "./theme";

const MILLIMETRES = 1e3;
const PATH_COLOUR = 4; // of one run alone; several have their own
const GROUND_COLOUR = 1;

/** Where the feet were at every frame, in the frame of the base, m: by leg. */
export function feetInBase(motion: Motion, run: Run): Vector3[][] {
  const { bodies, legs } = motion.scene;
  const paths: Vector3[][] = legs.map(() => []);
  const [base, toBase] = [new Matrix4(), new Matrix4()];
  const [place, turn, size] = [new Vector3(), new Quaternion(), new Vector3(1, 1, 1)];
  for (let frame = 0; frame < run.time.length; ++frame) {
    const pose = run.poses.subarray(7 * frame * bodies.length); // of the base: the first body
    toBase.copy(base.compose(place.fromArray(pose), turn.fromArray(pose, 3), size)).invert();
    legs.forEach((_, leg) =>
      paths[leg]!.push(new Vector3().fromArray(run.feet, 3 * (frame * legs.length + leg)).applyMatrix4(toBase)),
    );
  }
  return paths;
}

function loaded(run: Run, legs: number, leg: number, frame: number): boolean {
  const at = 3 * (frame * legs + leg);
  return Math.hypot(run.forces[at]!, run.forces[at + 1]!, run.forces[at + 2]!) > 0;
}

export function footPaths(motion: Motion, runs: Run[]): Chart[] {
  const { legs } = motion.scene;
  const several = runs.length > 1;
  const paths = runs.map((run) => feetInBase(motion, run));
  return legs.map((leg, index) => {
    const [x0, , z0] = leg.origin ?? [0, 0, 0];
    const series = runs.flatMap((run, i): Chart["series"] => {
      const points = paths[i]![index]!.map((p): [number, number] => [
        MILLIMETRES * (p.x - x0),
        MILLIMETRES * (p.z - z0),
      ]);
      if (several) return [{ label: run.name, colour: theme.run(run.index).slot, style: "path", points }];
      return [
        { label: "path", colour: PATH_COLOUR, style: "path", points },
        // A chart's dots are in the order of x.
        {
          label: "on the ground",
          colour: GROUND_COLOUR,
          style: "dots",
          points: points.filter((_, frame) => loaded(run, legs.length, index, frame)).sort((a, b) => a[0] - b[0]),
        },
      ];
    });
    return {
      title: `Foot ${leg.name} from the side`,
      x_label: `x forward in the ${leg.origin ? "leg frame" : "base"}, mm`,
      y_label: leg.origin ? "z up from hips or shoulders, mm" : "z up in the base, mm",
      x_log: false,
      y_log: false,
      equal_scales: true,
      y_names: [],
      series,
      boxes: [],
      shades: null,
    };
  });
}
