// The robots in 3D: ground, light, and what of them is shown.
import {
  Box3,
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
  PlaneGeometry,
  Scene as ThreeScene,
  Vector3,
  WebGLRenderer,
} from "three";
import { Detail, WHOLE, type Level } from "./detail";
import type { Live, Motion, Numbers, Run } from "./document";
import { fieldGeometry, fieldGrid, gridGeometry } from "./ground";
import type { Inside } from "./insides";
import { RobotParts, RobotView } from "./robot";
import { Tags, type Tagged } from "./tags";
import { theme } from "./theme";
import { middleOf, Viewpoint } from "./viewpoint";

/** Pixels of a whole picture over those of the page, along each side. */
const FINEST = 2;
const SMOOTH = 0.3; // s, either way: about a stride
/** Mean height of the base around a frame. */
function smoothHeight(run: Run, frame: number): number {
  const { time, poses } = run;
  const stride = poses.length / time.length;
  const now = time[frame] as number;
  let [sum, count] = [0, 0];
  for (let i = frame; i >= 0 && now - (time[i] as number) <= SMOOTH; --i, ++count) sum += poses[i * stride + 2]!;
  for (let i = frame + 1; i < time.length && (time[i] as number) - now <= SMOOTH; ++i, ++count)
    sum += poses[i * stride + 2]!;
  return sum / count;
}

export class View {
  readonly three = new ThreeScene();
  readonly robots: RobotView[] = [];
  readonly viewpoint: Viewpoint;
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
  // Behind the lines on it.
  private readonly groundMaterial = new MeshLambertMaterial({
    vertexColors: true,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 2,
  });
  private readonly gridMaterial = new LineBasicMaterial();
  private readonly sun = new DirectionalLight(0xffffff, 2.2);
  private readonly sky = new HemisphereLight(0xffffff, 0x8d8a80, 1.5);
  private readonly tags = new Tags();
  private readonly ghosts: boolean[] = [];
  private time = 0;
  private lit = 0;
  private readonly detail = new Detail(() => this.drawNow());
  private coarse = false;
  private drawnSince = 0;
  private pending = false;
  private disposed = false;
  private readonly endings: (() => void)[] = [];

  constructor(
    private readonly motion: Motion & Live,
    private readonly runs: Run[],
    private readonly numbers: Numbers,
    readonly canvas: HTMLCanvasElement,
    /** What is seen of the robots' insides once painted. */
    readonly insides = new Set<Inside>(),
  ) {
    this.shown = runs.map(() => true);
    theme.setRuns(runs.map((run) => run.name));
    // Kept after drawing, so that it can be printed and copied. Edges are smooth by finer pixels: those of one that moves
    // may be larger, while antialiasing is for ever.
    this.renderer = new WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = false; // each picture says
    this.renderer.debug.checkShaderErrors = false; // asking waits until they are compiled
    this.build();
    const room = this.radius();
    this.viewpoint = new Viewpoint(
      canvas,
      () => this.places(),
      this.size,
      room,
      () => this.draw(),
    );
    canvas.parentElement!.append(this.tags.element);
    this.paint();
    this.resize();
    this.viewpoint.look("quarter");
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(canvas.parentElement!);
    this.endings.push(
      theme.onChange(() => this.paint()),
      () => observer.disconnect(),
      () => this.viewpoint.controls.dispose(),
      () => this.tags.element.remove(),
      () => this.detail.end(),
    );
  }

  /** Gives up the canvas, which nothing can draw on any more. */
  dispose(): void {
    this.disposed = true;
    for (const end of this.endings) end();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  /** Of the first robot around its place, m, as it stands at first. */
  private radius(): number {
    const [robot] = this.robots;
    robot?.show(0, 0);
    const box = robot && new Box3().setFromObject(robot.solid).getSize(new Vector3());
    const half = box ? Math.hypot(box.x, box.y) / 2 : 0;
    return Math.max(1.6 * this.size, Number.isFinite(half) ? half : 0);
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
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.normalBias = 0.01 * this.size;
    this.sky.position.set(0, 0, 1);
    this.three.add(this.sun, this.sun.target, this.sky);
  }

  private groundOf(y0: number, y1: number): Group {
    const { ground, path, reach } = this.motion.scene;
    const group = new Group();
    const [x0, x1] = [path[0] - reach, path[2] + reach];
    // A line every tenth of a metre for a robot of a span, every metre for one of a man's height.
    const apart = this.size < 0.3 ? 0.1 : 1;
    if (ground) {
      const field = fieldGeometry(ground, this.numbers, y0, y1);
      group.add(
        new Mesh(field.geometry, this.groundMaterial),
        new LineSegments(fieldGrid(ground, field.points, field.rows, apart), this.gridMaterial),
      );
    } else {
      const plane = new PlaneGeometry(x1 - x0, y1 - y0).translate((x0 + x1) / 2, (y0 + y1) / 2, 0);
      plane.setAttribute("color", new BufferAttribute(new Float32Array(12).fill(1), 3));
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
      old.traverse(
        (part) => (part instanceof Mesh || part instanceof LineSegments) && (part.geometry as BufferGeometry).dispose(),
      );
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
    const seen = this.drawn();
    this.groups.forEach((group, i) => {
      group.visible = seen.includes(i);
      const place = seen.indexOf(i);
      const middle = inStrips && this.motion.live ? this.strips[i]!.middle : 0;
      group.position.y = this.sideBySide ? ((seen.length - 1) / 2 - place) * apart - middle : 0;
      const robot = this.robots[i]!;
      this.ghosts[i] = this.isGhost(i);
      robot.showInsides(this.insides);
      robot.paint(theme.runColour(i), !several, this.ghosts[i]!);
      robot.arrows.visible = this.forces;
      robot.trails.visible = this.trails;
      robot.support.visible = this.support;
    });
    this.draw();
  }

  /** The first run that is shown and does the same as this one. */
  standsFor(i: number): number {
    const same = (k: number) => this.motion.pairs.some((pair) => pair.a === k && pair.b === i && pair.same);
    const first = this.runs.findIndex((_, k) => k < i && this.shown[k] && same(k));
    return first < 0 ? i : first;
  }
  /** Runs that are drawn: of those that do the same the first alone. */
  private drawn(): number[] {
    return this.runs.flatMap((_, i) => (this.shown[i] && this.standsFor(i) === i ? [i] : []));
  }
  /** Over another robot, of which something would be hidden. */
  private isGhost(i: number): boolean {
    const first = this.drawn()[0] ?? i;
    if (i === first || this.sideBySide) return false;
    return this.placeOf(i).distanceTo(this.placeOf(first)) < 2 * this.size;
  }

  show(time: number, exact: boolean): void {
    this.time = time;
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
    const places = this.places();
    const base = middleOf(places);
    if (this.follow) this.viewpoint.goAlong(places);
    else this.viewpoint.letGo(places);
    if (this.motion.endless) this.carryGround(base);
    this.light(base, places);
    const several = this.runs.length > 1;
    for (const i of this.drawn()) {
      const ghost = this.isGhost(i);
      if (ghost !== this.ghosts[i]) this.robots[i]!.paint(theme.runColour(i), !several, ghost);
      this.ghosts[i] = ghost;
    }
    this.draw();
  }

  /** Shadows reach as far as the robots do. */
  private light(base: Vector3, places: Vector3[]): void {
    const reach = 6 * this.size + Math.max(0, ...places.map((place) => place.distanceTo(base)));
    this.sun.target.position.copy(base);
    this.sun.position.copy(base).add(new Vector3(0.35, -0.5, 1).multiplyScalar(3.4 * reach));
    if (Math.abs(reach - this.lit) < 0.05 * reach) return;
    this.lit = reach;
    const sides = { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.01, far: 12 * reach };
    Object.assign(this.sun.shadow.camera, sides);
    this.sun.shadow.camera.updateProjectionMatrix();
  }

  /** By whole metres, so that its lines stay where they are. */
  private carryGround(base: Vector3): void {
    this.ground?.position.set(Math.round(base.x), Math.round(base.y), 0);
  }

  /** Beside each other, or in one place. */
  stand(beside: boolean): void {
    this.sideBySide = beside;
    this.paint();
    this.viewpoint.look("quarter");
  }
  /** Once, however often it is asked for before the next picture. */
  draw(): void {
    if (this.pending || this.disposed) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (this.disposed) return;
      this.pending = false;
      this.drawNow(this.detail.next());
    });
  }
  drawNow(level = WHOLE): void {
    const { camera } = this.viewpoint;
    this.setLevel(level);
    this.renderer.render(this.three, camera);
    this.outside = this.tags.show(this.tagged(), camera, this.canvas.clientWidth, this.canvas.clientHeight);
  }
  private setLevel({ pixels, coarse, shadow }: Level): void {
    const ratio = pixels * FINEST;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    if (coarse !== this.coarse) for (const robot of this.robots) robot.coarse = coarse;
    this.coarse = coarse;
    this.renderer.shadowMap.needsUpdate = this.drawnSince++ % shadow === 0;
  }
  /** Robots that are out of sight. */
  outside = 0;

  /** Names, and what became of those whose motion has come to it. */
  private tagged(): Tagged[] {
    if (this.runs.length < 2) return [];
    return this.drawn().map((i) => {
      const { outcome, outcome_at_s: at } = this.runs[i]!.document;
      const names = this.runs.flatMap((run, k) => (this.shown[k] && this.standsFor(k) === i ? [run.name] : []));
      // What is known at the end alone is told then.
      const over = this.time >= (at ?? this.runs[i]!.time[this.runs[i]!.time.length - 1]! - 0.01);
      return {
        words: names.join(" = ") + (over && outcome ? `: ${outcome}` : ""),
        colour: theme.runColour(i),
        place: this.placeOf(i).add(new Vector3(0, 0, 0.9 * this.size)),
      };
    });
  }
  /** Where bases are in the picture, their heights smoothed: the camera is not to nod with them. */
  private places(): Vector3[] {
    const drawn = this.drawn();
    return (drawn.length > 0 ? drawn : [0]).map((i) => this.placeOf(i));
  }
  private placeOf(i: number): Vector3 {
    const run = this.runs[i]!;
    const object = this.robots[i]!.bodies[0]!;
    const y = this.groups[i]!.position.y;
    // In its strip a live robot is where the strip is.
    const along = this.inStrips && this.motion.live ? y + this.strips[i]!.middle : y + object.position.y;
    return new Vector3(object.position.x, along, smoothHeight(run, run.frameAt(this.time)));
  }
  private resize(): void {
    const box = this.canvas.parentElement!.getBoundingClientRect();
    if (box.width === 0 || box.height === 0) return;
    this.renderer.setSize(box.width, box.height, false);
    this.viewpoint.resize(box.width / box.height);
    this.drawNow();
  }
}
