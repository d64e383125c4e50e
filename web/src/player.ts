// The one time that robot and plots show, and what moves it.

export class Player {
  time: number;
  playing = false;
  speed = 1;
  private last = 0;
  private readonly listeners: (() => void)[] = [];

  /** @param frames times of all frames, s, ascending */
  constructor(readonly frames: Float32Array) {
    this.time = this.begin;
  }

  get begin(): number {
    return this.frames[0] as number;
  }
  get end(): number {
    return this.frames[this.frames.length - 1] as number;
  }
  /** A time as it is told, since the motion began: runs stand a while before. */
  since(time: number): number {
    return time - this.begin;
  }
  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  seek(time: number): void {
    this.time = Math.min(this.end, Math.max(this.begin, time));
    this.tell();
  }
  /** To a neighbouring frame, paused. */
  step(frames: number): void {
    this.playing = false;
    let nearest = 0;
    for (let i = 0; i < this.frames.length; ++i) {
      if (Math.abs((this.frames[i] as number) - this.time) < Math.abs((this.frames[nearest] as number) - this.time))
        nearest = i;
    }
    const target = Math.min(this.frames.length - 1, Math.max(0, nearest + frames));
    this.seek(this.frames[target] as number);
  }
  toggle(): void {
    this.playing = !this.playing;
    if (this.playing && this.time >= this.end) this.time = this.begin;
    if (this.playing) {
      this.last = performance.now();
      requestAnimationFrame((now) => this.advance(now));
    }
    this.tell();
  }

  private advance(now: number): void {
    if (!this.playing) return;
    // A page that was in the background goes on where it stopped.
    const passed = Math.min(0.25, Math.max(0, (now - this.last) / 1000));
    this.last = now;
    if (this.time + this.speed * passed >= this.end) this.playing = false;
    this.seek(this.time + this.speed * passed);
    requestAnimationFrame((next) => this.advance(next));
  }
  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
