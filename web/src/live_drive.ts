// The hands on the robot: keys and gamepad for its velocity, a pointer that pulls at it for pushes.
import { Plane, Raycaster, Vector2, Vector3 } from "three";
import type { LiveOptions, Velocity } from "./live_link";
import type { View } from "./view";

/** A key changes the velocity by this share of its limit. */
const STEP = 0.1;
/** Of a stick, that is not meant. */
const DEAD = 0.15;
/** Between two commands of a gamepad, ms. */
const PACE = 50;

const clamp = (value: number) => Math.min(1, Math.max(-1, value));

/** The velocity that is wanted, in shares of the limits, from whatever hand. */
export class Driver {
  private wanted: Velocity = { vx: 0, vy: 0, yaw_rate: 0 };
  private said = -Infinity;
  private stick = "";
  private stickSaid = 0;

  /** Of what is driven. */
  limits: LiveOptions["limits"] = { forward: 0, left: 0, yaw_rate: 0, push: 0 };

  constructor(private readonly send: (velocity: Velocity) => void) {
    requestAnimationFrame((now) => this.poll(now));
  }

  /** What the server goes by: another viewer may drive, too. Not while our own word is under way. */
  heard(velocity: Velocity): void {
    if (performance.now() - this.said > 300) this.wanted = { ...velocity };
  }
  set(velocity: Partial<Velocity>): void {
    this.wanted = { ...this.wanted, ...velocity };
    this.said = performance.now();
    this.send(this.wanted);
  }
  stop(): void {
    this.set({ vx: 0, vy: 0, yaw_rate: 0 });
  }
  /** By steps of a key. */
  change(forward: number, left: number, turn: number): void {
    const { vx, vy, yaw_rate } = this.wanted;
    const limits = this.limits;
    const next = (value: number, steps: number, most: number) =>
      most * clamp(Math.round((value / most + steps * STEP) / STEP) * STEP);
    this.set({
      vx: forward ? next(vx, forward, limits.forward) : vx,
      vy: left ? next(vy, left, limits.left) : vy,
      yaw_rate: turn ? next(yaw_rate, turn, limits.yaw_rate) : yaw_rate,
    });
  }

  /** Left stick: forward and sideways; right stick: turn. A stick at rest says so once and leaves the rest to keys. */
  private poll(now: number): void {
    const pad = navigator.getGamepads().find((p) => p?.connected && p.axes.length >= 3);
    if (pad && now - this.stickSaid >= PACE) {
      const axis = (i: number) => {
        const value = pad.axes[i] ?? 0;
        return Math.abs(value) < DEAD ? 0 : -Math.round(50 * value) / 50;
      };
      const share = [axis(1), axis(0), axis(2)] as const;
      const stick = share.join();
      if (stick !== (this.stick || "0,0,0")) {
        const { forward, left, yaw_rate } = this.limits;
        this.set({ vx: clamp(share[0]) * forward, vy: clamp(share[1]) * left, yaw_rate: clamp(share[2]) * yaw_rate });
        this.stickSaid = now;
      }
      this.stick = stick;
    }
    requestAnimationFrame((next) => this.poll(next));
  }
}

/** What pulling at the robot does. */
export interface Pulling {
  /** Whether a spring holds it, or a push is made where the pointer ends. */
  isSpring: () => boolean;
  push: (impulse: [number, number, number]) => void;
  /** Told a point in W, or null: let go. */
  pull: (to: [number, number, number] | null) => void;
  say: (words: string) => void;
}

/** Pulling at the robot: an impulse along the way of the pointer, larger the longer it is; or a spring to the pointer. */
export class Pusher {
  private from: Vector3 | null = null;
  private springs = false;
  /** From where it was taken hold of to the base's origin, which the spring holds. */
  private readonly offset = new Vector3();
  private to = new Vector3();
  private readonly ray = new Raycaster();

  constructor(
    private readonly view: View,
    private readonly size: number,
    private readonly most: number,
    private readonly pulling: Pulling,
  ) {
    const canvas = view.canvas;
    // Before the view, which would turn.
    canvas.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => this.end(event.type === "pointerup"));
  }

  private aim(event: PointerEvent): void {
    const box = this.view.canvas.getBoundingClientRect();
    this.ray.setFromCamera(
      new Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height),
      this.view.viewpoint.camera,
    );
  }
  private begin(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.aim(event);
    const hit = this.ray.intersectObjects(
      this.view.robots.map((robot) => robot.solid),
      true,
    )[0];
    if (!hit) return;
    this.from = hit.point.clone();
    this.springs = this.pulling.isSpring();
    const base = this.view.robots[0]!.bodies[0]!.position;
    this.offset.copy(base).sub(hit.point);
    this.to.copy(hit.point);
    this.view.viewpoint.controls.enabled = false;
    this.view.canvas.setPointerCapture(event.pointerId);
  }
  private move(event: PointerEvent): void {
    if (!this.from) return;
    this.aim(event);
    if (this.springs) return this.moveSpring();
    // In the level plane through where it was taken hold of.
    if (!this.ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -this.from.z), this.to)) return;
    this.pulling.say(`push ${this.impulse().length().toFixed(3)} N s`);
  }
  /** In the plane of the picture through where it was taken hold of. */
  private moveSpring(): void {
    const facing = this.view.viewpoint.camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(facing, this.from!);
    if (!this.ray.ray.intersectPlane(plane, this.to)) return;
    const { x, y, z } = this.to.clone().add(this.offset);
    this.pulling.pull([x, y, z]);
  }
  /** Two standing heights are as much as there is. */
  private impulse(): Vector3 {
    return this.to
      .clone()
      .sub(this.from!)
      .multiplyScalar(this.most / (2 * this.size))
      .clampLength(0, 0.999 * this.most);
  }
  private end(done: boolean): void {
    if (!this.from) return;
    const impulse = this.impulse();
    this.from = null;
    this.view.viewpoint.controls.enabled = true;
    this.pulling.say("");
    if (this.springs) return this.pulling.pull(null);
    if (done && impulse.length() > 0.02 * this.most) this.pulling.push([impulse.x, impulse.y, 0]);
  }
}
