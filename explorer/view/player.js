// The clock of a motion: it runs, rests at the end, and begins anew.

import { CLOCK, T, stateAt } from "./physics.js";

const REST = 1.4; // s between the end of the motion and the next beginning

/** Whether the page may move of its own accord. */
export const mayMove = () => !matchMedia("(prefers-reduced-motion: reduce)").matches;

export class Player {
  constructor(store, running) {
    this.store = store;
    this.clock = 0;
    this.rest = 0;
    this.running = running;
  }

  /** A little after the first race: what a page shows that must not move. */
  afterRace() {
    const { states, turns } = this.store.main;
    return turns.length ? states[turns[0]][CLOCK] + 1.2 : 0;
  }

  get end() {
    const { states } = this.store.main;
    return states[states.length - 1][CLOCK];
  }

  toggle() {
    if (!this.running && this.clock >= this.end) this.clock = 0;
    this.running = !this.running;
    this.rest = 0;
  }

  restart() {
    this.clock = this.rest = 0;
  }

  seek(clock) {
    this.clock = Math.min(this.end, Math.max(0, clock));
    this.rest = 0;
  }

  /** Let `seconds` go by; without `slow` real time runs and a race is over in an instant. */
  advance(seconds) {
    if (!this.running) return;
    const { shown, main } = this.store;
    const step = shown.pace * seconds;
    if (this.clock >= this.end) {
      this.rest += seconds;
      if (this.rest > REST) this.restart();
    } else if (shown.slow) this.clock = Math.min(this.end, this.clock + step);
    else {
      const t = stateAt(main, CLOCK, this.clock)[T] + step;
      const { states } = main;
      this.clock = t >= states[states.length - 1][T] ? this.end : stateAt(main, T, t)[CLOCK];
    }
  }
}
