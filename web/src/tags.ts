// Names over the robots in the picture, and arrows at its edge to those that are out of sight.
import { Vector3, type PerspectiveCamera } from "three";
import { h } from "./dom";

/** What a robot is called, and where its name belongs. */
export interface Tagged {
  words: string;
  colour: string;
  /** In the world. */
  place: Vector3;
}

const HEIGHT = 20; // px of a name
const EDGE = 14; // px

export class Tags {
  readonly element = h("div", { class: "tags", "aria-hidden": "true" });
  private readonly tags: HTMLElement[] = [];

  /** @returns how many are out of sight */
  show(all: Tagged[], camera: PerspectiveCamera, width: number, height: number): number {
    while (this.tags.length < all.length) {
      const tag = h("span", { class: "tag" }, h("i", {}, "\u279c"), h("b", {}));
      this.tags.push(tag);
      this.element.append(tag);
    }
    const placed: { x: number; y: number; width: number }[] = [];
    let outside = 0;
    this.tags.forEach((tag, i) => {
      const tagged = all[i];
      tag.hidden = !tagged;
      if (!tagged) return;
      const seen = tagged.place.clone().project(camera);
      const behind = seen.z > 1;
      const out = behind || Math.abs(seen.x) > 1 || Math.abs(seen.y) > 1;
      if (out) ++outside;
      // What is behind is projected through the eye: the way to it is the other way.
      const [sx, sy] = behind ? [-seen.x, -seen.y] : [seen.x, seen.y];
      const shrink = out ? 1 / Math.max(Math.abs(sx), Math.abs(sy), 1e-6) : 1;
      tag.style.setProperty("--colour", tagged.colour);
      tag.lastElementChild!.textContent = tagged.words;
      tag.classList.toggle("out", out);
      (tag.firstElementChild as HTMLElement).style.transform = `rotate(${Math.atan2(-sy, sx)}rad)`;
      const wide = 7 * tagged.words.length + (out ? 34 : 16); // about
      let x = (0.5 + 0.5 * sx * shrink) * width;
      let y = (0.5 - 0.5 * sy * shrink) * height;
      x = Math.min(width - wide / 2 - EDGE / 2, Math.max(wide / 2 + EDGE / 2, x));
      y = Math.min(height - HEIGHT, Math.max(HEIGHT, y));
      // Names of robots in one place stand over each other.
      const step = y < height / 2 && out ? HEIGHT + 2 : -(HEIGHT + 2);
      while (placed.some((p) => Math.abs(p.y - y) < HEIGHT && Math.abs(p.x - x) < (p.width + wide) / 2)) y += step;
      placed.push({ x, y, width: wide });
      tag.style.left = `${x}px`;
      tag.style.top = `${y}px`;
    });
    return outside;
  }
}
