// Where robots are looked at from: camera, presets, and that all of them stay in the picture.
import { Box3, PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

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

/** Of the box around them. */
export function middleOf(places: Vector3[]): Vector3 {
  return new Box3().setFromPoints(places).getCenter(new Vector3());
}

export class Viewpoint {
  readonly camera = new PerspectiveCamera(36, 1, 0.01, 500);
  readonly controls: OrbitControls;
  /** The last that was asked for, until the view is turned by hand. */
  preset: Preset | null = "quarter";
  /** Called when the view is turned by hand, or looks elsewhere. */
  onLook: () => void = () => {};
  private watched: Vector3[];

  /**
   * @param places  where robots are now
   * @param size  standing height of a robot, m
   * @param room  around its place, m
   * @param draw  called whenever the camera has moved
   */
  constructor(
    canvas: HTMLCanvasElement,
    private readonly places: () => Vector3[],
    private readonly size: number,
    private readonly room: number,
    private readonly draw: () => void,
  ) {
    this.camera.up.set(0, 0, 1);
    this.watched = places();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", draw);
    this.controls.addEventListener("start", () => (this.preset = null));
    this.controls.addEventListener("end", () => this.onLook());
  }

  /** With the robots, and back as they part, so that all are in the picture. */
  goAlong(places: Vector3[]): void {
    const [before, now] = [middleOf(this.watched), middleOf(places)];
    const further = this.distanceFor(places) / this.distanceFor(this.watched);
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(further);
    this.controls.target.add(now.sub(before));
    this.camera.position.copy(this.controls.target).add(offset);
    this.camera.updateMatrixWorld();
    this.watched = places;
  }
  /** Stays where it is while they go. */
  letGo(places: Vector3[]): void {
    this.watched = places;
  }

  look(preset: Preset): void {
    this.lookFrom(new Vector3(...DIRECTIONS[preset]).normalize(), 1);
    this.preset = preset;
    this.onLook();
  }
  /** As `look` or by hand: a preset, or azimuth and elevation, deg, and how much nearer. */
  get direction(): string {
    if (this.preset) return this.preset;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const [azimuth, elevation] = [Math.atan2(offset.y, offset.x), Math.asin(offset.z / offset.length())];
    const degrees = [azimuth, elevation].map((angle) => Math.round((180 / Math.PI) * angle));
    return [...degrees, (this.distanceFor(this.places()) / offset.length()).toFixed(2)].join(",");
  }
  set direction(words: string) {
    const preset = PRESETS.find(([name]) => name === words)?.[0];
    if (preset) {
      this.look(preset);
      return;
    }
    const [azimuth, elevation, nearer] = words.split(",").map(Number);
    if (![azimuth, elevation, nearer].every(Number.isFinite) || nearer! <= 0) return;
    const [a, e] = [(Math.PI / 180) * azimuth!, (Math.PI / 180) * Math.min(89, Math.max(-5, elevation!))];
    this.lookFrom(new Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)), nearer!);
    this.preset = null;
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
    this.preset = null;
    this.onLook();
    this.draw();
  }
  /** Whoever was in the picture stays in it: a narrower one is seen from further off. */
  resize(aspect: number): void {
    const was = this.distanceFor(this.watched);
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    this.camera.position.copy(target).addScaledVector(offset, this.distanceFor(this.watched) / was);
  }

  /** @param direction  to the camera, of length one  @param nearer  than where all robots are in the picture */
  private lookFrom(direction: Vector3, nearer: number): void {
    const places = this.places();
    const target = middleOf(places).sub(new Vector3(0, 0, 0.35 * this.size));
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(direction);
    this.camera.lookAt(target);
    this.camera.position.copy(target).addScaledVector(direction, this.distanceFor(places) / nearer);
    this.watched = places;
    this.controls.update();
    this.draw();
  }
  /** How far from their middle the camera sees all robots, m, in the direction that it looks in. */
  private distanceFor(places: Vector3[]): number {
    const middle = middleOf(places);
    const turned = this.camera.quaternion.clone().invert();
    let [wide, high, deep] = [0, 0, 0];
    for (const place of places) {
      const seen = place.clone().sub(middle).applyQuaternion(turned);
      wide = Math.max(wide, Math.abs(seen.x));
      high = Math.max(high, Math.abs(seen.y));
      deep = Math.max(deep, Math.abs(seen.z));
    }
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const { room } = this;
    return deep + Math.max(11 * this.size, (wide + room) / (slope * this.camera.aspect), (high + room) / slope);
  }
}
