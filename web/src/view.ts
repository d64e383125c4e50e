// The robots in 3D: ground, light, camera, and what of them is shown.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene as ThreeScene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Ground, Live, Motion, Numbers, Run } from "./document";
import { RobotParts, RobotView } from "./robot";
import { theme } from "./theme";

export type Preset = "quarter" | "side" | "front" | "top";
/** Name, label and key. */
export const PRESETS: [Preset, string, string][] = [
  ["quarter", "\u00be", "1"],
  ["side", "side", "2"],
  ["front", "front", "3"],
  ["top", "top", "4"],
];
const DIRECTIONS: Record<Preset, [number, number, number]> = {
  quarter: [0.72, -1, 0.62],
  side: [0, -1, 0.16],
  front: [1, 0, 0.22],
  top: [-0.001, -0.001, 1],
};

function fieldGeometry(ground: Ground, numbers: Numbers, low: number, high: number): BufferGeometry {
  const heights = numbers.floats(ground.heights);
  // Rows within [low, high] along y, two at least.
  const first = Math.max(0, Math.min(ground.rows - 2, Math.floor((low - ground.y) / ground.cell_y)));
  const last = Math.max(first + 1, Math.min(ground.rows - 1, Math.ceil((high - ground.y) / ground.cell_y)));
  const { columns } = ground;
  const rows = last - first + 1;
  const points = new Float32Array(3 * columns * rows);
  const shades = new Float32Array(3 * columns * rows);
  let lowest = Infinity;
  let highest = -Infinity;
  for (const height of heights) {
    lowest = Math.min(lowest, height);
    highest = Math.max(highest, height);
  }
  for (let r = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const at = 3 * (r * columns + c);
      const height = heights[(first + r) * columns + c] as number;
      points.set([ground.x + c * ground.cell_x, ground.y + (first + r) * ground.cell_y, height], at);
      const shade = 0.72 + (0.28 * (height - lowest)) / Math.max(1e-9, highest - lowest);
      shades.fill(shade, at, at + 3);
    }
  }
  const triangles = new Uint32Array(6 * (columns - 1) * (rows - 1));
  let k = 0;
  for (let r = 0; r + 1 < rows; ++r) {
    for (let c = 0; c + 1 < columns; ++c) {
      const a = r * columns + c;
      // Split along (c, r)-(c + 1, r + 1), as the engines do.
      triangles.set([a, a + 1, a + columns + 1, a, a + columns + 1, a + columns], k);
      k += 6;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setAttribute("color", new BufferAttribute(shades, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.computeVertexNormals();
  return geometry;
}

/** Lines at every `apart`, a little above a plane. */
function gridGeometry(x0: number, x1: number, y0: number, y1: number, apart: number): BufferGeometry {
  const points: number[] = [];
  const z = 2e-4;
  // In pieces: some graphics drivers leave out a line of which one end is behind the camera.
  const pieces = (from: number, to: number, add: (a: number, b: number) => void) => {
    const count = Math.ceil((to - from) / (10 * apart));
    for (let i = 0; i < count; ++i) add(from + ((to - from) * i) / count, from + ((to - from) * (i + 1)) / count);
  };
  for (let x = Math.ceil(x0 / apart); x * apart <= x1; ++x)
    pieces(y0, y1, (a, b) => points.push(x * apart, a, z, x * apart, b, z));
  for (let y = Math.ceil(y0 / apart); y * apart <= y1; ++y)
    pieces(x0, x1, (a, b) => points.push(a, y * apart, z, b, y * apart, z));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  return geometry;
}

export class View {
  readonly three = new ThreeScene();
  readonly camera = new PerspectiveCamera(36, 1, 0.01, 500);
  readonly robots: RobotView[] = [];
  readonly controls: OrbitControls;
  follow = true;
  sideBySide = false;
  forces = true;
  trails = true;
  support = false;
  readonly shown: boolean[];
  private readonly renderer: WebGLRenderer;
  private readonly groups: Group[] = [];
  private ground: Group | null = null;
  /** Of every run, made when they first stand side by side: the ground around it, and where along y its middle is. */
  private strips: { ground: Group; middle: number }[] = [];
  private readonly groundMaterial = new MeshLambertMaterial({ vertexColors: true });
  private readonly gridMaterial = new LineBasicMaterial();
  private readonly sun = new DirectionalLight(0xffffff, 2.2);
  private readonly sky = new HemisphereLight(0xffffff, 0x8d8a80, 1.5);
  private readonly watched = new Vector3();
  private pending = false;
  private disposed = false;
  private readonly endings: (() => void)[] = [];

  constructor(
    private readonly motion: Motion & Live,
    private readonly runs: Run[],
    private readonly numbers: Numbers,
    readonly canvas: HTMLCanvasElement,
  ) {
    this.shown = runs.map(() => true);
    // Kept after drawing, so that it can be printed and copied.
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.debug.checkShaderErrors = false; // asking waits until they are compiled
    this.camera.up.set(0, 0, 1);
    this.build();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.watched.copy(this.base());
    this.look("quarter");
    this.paint();
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(canvas.parentElement!);
    this.endings.push(
      theme.onChange(() => this.paint()),
      () => observer.disconnect(),
      () => this.controls.dispose(),
    );
    this.resize();
  }

  /** Gives up the canvas, which nothing can draw on any more. */
  dispose(): void {
    this.disposed = true;
    for (const end of this.endings) end();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private get size(): number {
    return this.motion.scene.standing_height || 0.2;
  }

  private build(): void {
    const { scene } = this.motion;
    const parts = new RobotParts(scene, this.numbers);
    const loads: number[] = [];
    for (const { forces } of this.runs) {
      for (let i = 0; i < forces.length; i += 3) loads.push(Math.hypot(forces[i]!, forces[i + 1]!, forces[i + 2]!));
    }
    // A usual load makes an arrow as long as a leg. Blows at touchdown, of which hard contacts have many, do not count.
    const loaded = loads.filter((load) => load > 0).sort((a, b) => a - b);
    const perNewton = this.size / (this.motion.usual_load ?? loaded[Math.floor(loaded.length / 2)] ?? 1);
    for (const run of this.runs) {
      const group = new Group();
      const robot = new RobotView(run, parts, perNewton);
      robot.name = run.name;
      group.add(robot);
      this.three.add(group);
      this.robots.push(robot);
      this.groups.push(group);
    }
    const [, y0, , y1] = scene.path;
    this.ground = this.groundOf(y0 - scene.reach, y1 + scene.reach);
    this.three.add(this.ground);
    const reach = 6 * this.size;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    Object.assign(this.sun.shadow.camera, {
      left: -reach,
      right: reach,
      top: reach,
      bottom: -reach,
      near: 0.01,
      far: 12 * reach,
    });
    this.sun.shadow.normalBias = 0.01 * this.size;
    this.sky.position.set(0, 0, 1);
    this.three.add(this.sun, this.sun.target, this.sky);
  }

  private groundOf(y0: number, y1: number): Group {
    const { ground, path, reach } = this.motion.scene;
    const group = new Group();
    const [x0, x1] = [path[0] - reach, path[2] + reach];
    if (ground) {
      group.add(new Mesh(fieldGeometry(ground, this.numbers, y0, y1), this.groundMaterial));
    } else {
      const plane = new PlaneGeometry(x1 - x0, y1 - y0).translate((x0 + x1) / 2, (y0 + y1) / 2, 0);
      plane.setAttribute("color", new BufferAttribute(new Float32Array(12).fill(1), 3));
      // A line every tenth of a metre for a robot of a span, every metre for one of a man's height.
      const apart = this.size < 0.3 ? 0.1 : 1;
      group.add(
        new Mesh(plane, this.groundMaterial),
        new LineSegments(gridGeometry(x0, x1, y0, y1, apart), this.gridMaterial),
      );
    }
    group.children[0]!.receiveShadow = true;
    return group;
  }

  /** Each robot on ground of its own: a plane is the same everywhere. */
  private get inStrips(): boolean {
    return this.sideBySide && !this.motion.endless;
  }

  /** Of a replay the ground beside the whole way, of a live robot that around it. */
  private stripOf(i: number): { ground: Group; middle: number } {
    const [, y0, , y1] = this.motion.scene.path;
    const beside = 2.6 * this.size;
    const middle = this.motion.live ? this.robots[i]!.bodies[0]!.position.y : 0;
    const ground = this.motion.live
      ? this.groundOf(middle - beside, middle + beside)
      : this.groundOf(y0 - beside, y1 + beside);
    this.groups[i]!.add(ground);
    return { ground, middle };
  }

  /** Strips of live robots that have left the middle of theirs. */
  private moveStrips(): void {
    const left = this.strips.flatMap((strip, i) =>
      Math.abs(this.robots[i]!.bodies[0]!.position.y - strip.middle) > this.size ? [i] : [],
    );
    for (const i of left) {
      const old = this.strips[i]!.ground;
      this.groups[i]!.remove(old);
      old.traverse((part) => part instanceof Mesh && (part.geometry as BufferGeometry).dispose());
      this.strips[i] = this.stripOf(i);
    }
    if (left.length > 0) this.paint();
  }

  /** Colours, and what is there at all. */
  paint(): void {
    const several = this.runs.length > 1;
    const [, y0, , y1] = this.motion.scene.path;
    const apart = (this.motion.live ? 0 : y1 - y0) + 5.4 * this.size;
    const { inStrips } = this;
    this.groundMaterial.color.set(theme.variable("--ground"));
    this.gridMaterial.color.set(theme.variable("--grid"));
    this.three.background = new Color(theme.variable("--sky"));
    this.sky.intensity = theme.name === "dark" ? 1.1 : 1.7;
    if (inStrips && this.strips.length === 0) this.strips = this.groups.map((_, i) => this.stripOf(i));
    if (this.ground) this.ground.visible = !inStrips;
    for (const strip of this.strips) strip.ground.visible = inStrips;
    const seen = this.shown.flatMap((shown, i) => (shown ? [i] : []));
    this.groups.forEach((group, i) => {
      group.visible = this.shown[i]!;
      const place = seen.indexOf(i);
      const middle = inStrips && this.motion.live ? this.strips[i]!.middle : 0;
      group.position.y = this.sideBySide ? ((seen.length - 1) / 2 - place) * apart - middle : 0;
      const robot = this.robots[i]!;
      robot.paint(theme.colour(i), !several, several && !this.sideBySide && place > 0);
      robot.arrows.visible = this.forces;
      robot.trails.visible = this.trails;
      robot.support.visible = this.support;
    });
    this.draw();
  }

  show(time: number, exact: boolean): void {
    this.robots.forEach((robot, i) => {
      const run = this.runs[i]!;
      const frame = run.frameAt(time);
      const from = run.time[frame] as number;
      const to = run.time[Math.min(frame + 1, run.time.length - 1)] as number;
      // Paused, a frame is shown as it is; in motion the way between two is smoothed.
      const share = exact || to <= from ? 0 : Math.min(1, Math.max(0, (time - from) / (to - from)));
      robot.show(frame, share);
    });
    if (this.inStrips && this.motion.live) this.moveStrips();
    const base = this.base();
    if (this.follow) {
      const moved = base.clone().sub(this.watched);
      this.camera.position.add(moved);
      this.controls.target.add(moved);
    }
    this.watched.copy(base);
    if (this.motion.endless) this.carryGround(base);
    this.sun.target.position.copy(base);
    this.sun.position.copy(base).add(new Vector3(0.35, -0.5, 1).multiplyScalar(20 * this.size));
    this.draw();
  }

  /** By whole metres, so that its lines stay where they are. */
  private carryGround(base: Vector3): void {
    this.ground?.position.set(Math.round(base.x), Math.round(base.y), 0);
  }

  look(preset: Preset): void {
    const wide = this.sideBySide ? 1 + 0.6 * (this.shown.filter(Boolean).length - 1) : 1;
    const target = this.base().sub(new Vector3(0, 0, 0.35 * this.size));
    if (this.sideBySide && !this.motion.endless) target.y = 0;
    const direction = new Vector3(...DIRECTIONS[preset]).normalize();
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, 11 * wide * this.size);
    this.controls.update();
    this.draw();
  }
  /** By angles (rad) around the robot, and nearer by a factor. */
  turn(azimuth: number, elevation: number, nearer: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const radius = offset.length() / nearer;
    const heading = Math.atan2(offset.y, offset.x) + azimuth;
    const height = Math.min(1.55, Math.max(-0.1, Math.asin(offset.z / offset.length()) + elevation));
    offset.set(Math.cos(height) * Math.cos(heading), Math.cos(height) * Math.sin(heading), Math.sin(height));
    this.camera.position.copy(this.controls.target).addScaledVector(offset, radius);
    this.controls.update();
    this.draw();
  }

  /** Once, however often it is asked for before the next picture. */
  draw(): void {
    if (this.pending || this.disposed) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (this.disposed) return;
      this.pending = false;
      this.renderer.render(this.three, this.camera);
    });
  }
  drawNow(): void {
    this.renderer.render(this.three, this.camera);
  }

  /** Of the first robot that is shown; its height is smoothed away: the camera is not to nod with it. */
  private base(): Vector3 {
    const run = Math.max(0, this.shown.indexOf(true));
    const { poses } = this.runs[run]!;
    const object = this.robots[run]?.bodies[0];
    const x = object ? object.position : new Vector3().fromArray(poses, 0);
    // In its strip a live robot is where the strip is.
    return new Vector3(x.x, this.inStrips && this.motion.live ? 0 : x.y, poses[2]);
  }
  private resize(): void {
    const box = this.canvas.parentElement!.getBoundingClientRect();
    if (box.width === 0 || box.height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(box.width, box.height, false);
    this.camera.aspect = box.width / box.height;
    this.camera.updateProjectionMatrix();
    this.drawNow();
  }
}
