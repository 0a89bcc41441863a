// The scenes of the article, in their order.
//
// name     of the section of article.html that has the prose
// shows    what the picture is, for who does not see it
// start    the motion, where it differs from the common one: a uniform disk, upright, pushed over, without rolling
// slider   what the slider is called; range: least, largest, step and first value
// changes  what the slider's value sets of the motion; where there is none it moves time through span(path)
// rest     from where the motion is shown when the slider moves: its "start" (and always on F), "flat" or (else) risen;
//          a motion that does not play is shown there, and one that would show its start at its end
// value    what stands beside the slider; says: what stands under the picture
// and what the picture has: plot (a ruler, with the wall or without), camera, aim and table, posed (nothing moves),
// plain (no colour of a side), bare (no mark and no trail of the contact), sides (the slider crosses F),
// both (the motion on the other side of F is shown too)

import { format, lengthWords } from "./chart.js";
import { CHI, CLOCK, PSI, Q, T, slowing, tiltOf, turningState } from "./physics.js";
import { placeToEtaHat } from "./state.js";

/** The disk of the article is ten centimetres wide. */
export const RADIUS = 0.05;
const GRAVITY = 9.81;
const SPEED = Math.sqrt(GRAVITY * RADIUS); // m/s, of 1 in natural units
const SECONDS = Math.sqrt(RADIUS / GRAVITY);
const DEGREES = 180 / Math.PI;
const FLATTEST = 0.01; // degrees of the coin that is shown flat: one that lies flat has no motion
export const HALF_RACE = 1.5; // of the clock, before and after the lowest point: all of the race

const last = (path) => path.states[path.states.length - 1];
/** The height of the far edge above the table, m. */
const edge = (x) => 2 * RADIUS * x[Q];
const turns = (angle) => `${(Math.abs(angle) / (2 * Math.PI)).toFixed(2)} turns`;
const nearest = ({ store }) => 2 * RADIUS * Math.sin(store.numbers.theta_min);
const fallTime = ({ store }) => (SECONDS * last(store.main)[T]).toFixed(3);
const speed = ({ store }) => `${lengthWords(SPEED * Math.abs(store.shown.eta_hat))}/s`;
const rolling = (figure) => {
  const { eta_hat } = figure.store.shown;
  return eta_hat ? `${speed(figure)} to the ${eta_hat > 0 ? "right" : "left"}` : "not at all: F";
};

/** How much slower than the coin the picture is. */
export const slowed = (x) => `time slowed ${format(Number((slowing(x) / SECONDS).toPrecision(2)), 2)} times`;
/** Time since the lowest point, or before it. */
const sinceLowest = ({ state, store }) => {
  const seconds = SECONDS * (state[T] - turningState(store.main, 0)[T]);
  if (Math.abs(seconds) < 1e-7) return "lowest";
  return `${lengthWords(Math.abs(seconds), "s")} ${seconds < 0 ? "before" : "after"} it is lowest`;
};

/** What is as high, m. */
const THINGS = [[1e-2, "A finger"], [7e-5, "A hair"], [1e-6, "A bacterium"], [2e-8, "A virus"], [2e-10, "An atom"],
  [1e-14, "The nucleus of an atom"], [0, "Not even the nucleus of an atom"]];
const fits = (height) => `${THINGS.find(([size]) => height >= size)[1]} would fit under it.`;

export const SCENES = [
  {
    name: "coin", shows: "A coin that leans on a table.", posed: true, bare: true,
    slider: "tilt", range: [0, 90, 1, 60],
    changes: (degrees) => ({ theta: Math.max(FLATTEST, degrees) / DEGREES }),
    aim: { x: -0.2, z: 0.55, radius: 2.1 }, table: { x: -0.2 },
    value: ({ store }) => `${Math.round(store.shown.theta * DEGREES)}°`,
    says: ({ state }) => `Its upper edge is ${(100 * edge(state)).toFixed(1)} cm above the table.`,
  },
  {
    name: "contact", shows: "A coin that wobbles round, with the point where it touches.",
    posed: true, plain: true,
    start: { theta: 25 / DEGREES, phidot: 0, sigma3_bar: 1.2814809452021245, eta_hat: 0.19917268233480204 },
    slider: "the point of contact goes round", range: [0, 1, 0.005, 0.1],
    span: (path) => [0, (2 * Math.PI * last(path)[CLOCK]) / last(path)[CHI]],
    aim: { x: 0, z: 0.3, radius: 1.7 }, table: { x: 0 },
    value: ({ state }) => `${Math.round(state[CHI] * DEGREES)}°`,
    says: ({ state }) => `The coin itself has turned by ${Math.round((state[CHI] - state[PSI]) * DEGREES)}°.`,
  },
  {
    name: "fall", shows: "A coin on its edge is pushed over and falls flat.", rest: "start",
    slider: "push, at its upper edge", range: [0.3, 3, 0.1, 1.4],
    changes: (push) => ({ phidot: push / (2 * SPEED) }),
    value: ({ slider }) => `${Number(slider.value).toFixed(1)} m/s`,
    says: (figure) => `Flat after ${fallTime(figure)} seconds.`,
  },
  {
    name: "rise", shows: "A coin that rolls a little falls, and stands up again.", rest: "start",
    slider: "how fast it rolls", range: [0, 20, 0.5, 6],
    changes: (speed) => ({ eta_hat: speed / (100 * SPEED) }),
    value: ({ slider }) => `${Number(slider.value).toFixed(1)} cm/s`,
    says: (figure) => (figure.store.shown.eta_hat
      ? `The least tilt is ${(figure.store.numbers.theta_min * DEGREES).toFixed(1)}°. Then it stands up again.`
      : `Without rolling it falls flat, after ${fallTime(figure)} seconds.`),
  },
  {
    name: "near", shows: "A coin that comes ever nearer to flat, and rises.", rest: "flat", plot: "ruler",
    slider: "how fast it rolls", range: [-13.5, -1, 0.05, -3],
    changes: (decades) => ({ eta_hat: 10 ** decades / SPEED }),
    value: speed,
    says: (figure) => `Lowest: ${lengthWords(nearest(figure))} under the far edge. ${fits(nearest(figure))}`,
  },
  {
    name: "slow-motion", shows: "The point of contact races round the rim of the coin, which lies almost flat.",
    start: { eta_hat: 1e-3 }, camera: { elevation: 0.95 }, aim: { z: 0.3, radius: 2.3 },
    slider: "time", range: [0, 1, 0.002, 0.6],
    span: (path) => [-1, 1].map((side) => turningState(path, 0)[CLOCK] + side * HALF_RACE),
    value: sinceLowest,
    says: ({ race, state, store }) => `The dot has raced ${turns(race.turned)}. The coin's tilt is `
      + `${(tiltOf(state, store.shown.face) * DEGREES).toFixed(2)}°.`,
  },
  {
    name: "sides", shows: "Two coins that have risen in two places, one for each side of F.", sides: true, both: true,
    camera: { azimuth: 0 },
    slider: "rolling", range: [-0.9, 0.9, 0.01, 0.5],
    changes: (place) => ({ eta_hat: placeToEtaHat(place) }),
    value: rolling,
    says: ({ store }) => (store.shown.eta_hat
      ? `The race goes ${turns(store.numbers.race_angle)} ${store.shown.eta_hat > 0 ? "counterclockwise" : "clockwise"}.`
      : "On F it falls flat. What comes next, nobody can tell."),
  },
  {
    name: "wall", shows: "A coin that lies almost flat, and the hill that it would have to climb.", rest: "flat",
    sides: true, plot: "wall", slider: "rolling", range: [-0.9, 0.9, 0.01, 0.5],
    changes: (place) => ({ eta_hat: placeToEtaHat(place) }),
    value: rolling,
    says: (figure) => (figure.store.shown.eta_hat
      ? `The wall turns it back at ${lengthWords(nearest(figure))} under the far edge.`
      : `On F there is no wall: after ${fallTime(figure)} seconds the coin lies flat.`),
  },
];
