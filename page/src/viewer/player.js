// Time: which frame is shown, and whether it runs.

/** Events: `frame` when another frame is shown, `state` when it starts, stops or changes speed. */
export class Player extends EventTarget {
  /** `count` frames, the first with number `first`, `rate` a second. */
  constructor({ count, first, rate }) {
    super();
    this.count = count;
    this.first = first;
    this.rate = rate;
    this.frame = 0;
    this.speed = 1;
    this.playing = false;
  }

  /** [s] since the first frame. */
  get time() {
    return this.frame / this.rate;
  }

  get last() {
    return this.count - 1;
  }

  seek(frame) {
    const bounded = Math.min(this.last, Math.max(0, frame));
    if (bounded === this.frame) return;
    this.frame = bounded;
    this.dispatchEvent(new Event("frame"));
  }

  step(frames) {
    this.pause();
    this.seek(Math.round(this.frame) + frames);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.dispatchEvent(new Event("state"));
  }

  play() {
    if (this.playing || this.count < 2) return;
    if (this.frame >= this.last) this.seek(0);
    this.playing = true;
    this.dispatchEvent(new Event("state"));
    let before = null;
    const tick = (now) => {
      if (!this.playing) return;
      if (before !== null) this.seek(this.frame + ((now - before) / 1000) * this.speed * this.rate);
      before = now;
      if (this.frame >= this.last) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    // Between two frames pieces stand where nothing was computed.
    this.seek(Math.round(this.frame));
    this.dispatchEvent(new Event("state"));
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }
}
